/// What a material samples against what it says of a given direction.
#include "core/shading/bsdf.h"

#include <numbers>

#include <gtest/gtest.h>

#include "core/scene/features.h"
#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

using Surface = SurfaceMaterial<kEverything, double>;
using Kind = Material::Kind;

const Vec3<double> kColour(0.9, 0.5, 0.1);

Surface surface_of(Kind kind, double parameter = 0) {
    return {static_cast<std::int64_t>(kind), parameter};
}

/// Its normal up, met from above.
SurfacePoint<double> ground() {
    SurfacePoint<double> point{};
    point.normal = point.outward = {0, 0, 1};
    point.is_front = true;
    return point;
}

const Vec3<double> kDown(0.6, 0, -0.8);

BsdfSample<double> sample(const Surface& surface, RandomInputs& random) {
    const auto [u, v] = random.unit_square<double>();
    return sample_bsdf<kEverything, double, Splitting::Off>(ground(), surface, kDown, {u, v, 0.5, 0.5}, false);
}
Vec3<double> sampled(const Surface& surface, RandomInputs& random) {
    return sample(surface, random).direction;
}

double density(const Surface& surface, const Vec3<double>& direction) {
    return bsdf_density<kEverything, double>(ground(), surface, kDown, direction);
}

Vec3<double> value(const Surface& surface, const Vec3<double>& direction) {
    return bsdf_value<kEverything, double>(ground(), surface, kColour, kDown, direction);
}

TEST(BsdfDensity, IsThatOfTheSampledDirections) {
    // Cells of equal solid angle over the whole sphere, that below the surface too.
    constexpr int kRows = 20;
    constexpr int kColumns = 8;
    const Surface diffuse = surface_of(Kind::Diffuse);
    std::vector<double> counts(kRows * kColumns);
    RandomInputs random(11);
    for (int i = 0; i < kDraws; ++i) {
        const Vec3<double> d = sampled(diffuse, random);
        const int row = std::min(static_cast<int>((d[2] + 1) / 2 * kRows), kRows - 1);
        const int column = std::min(
            static_cast<int>((std::atan2(d[1], d[0]) / (2 * std::numbers::pi) + 0.5) * kColumns), kColumns - 1);
        ++counts[static_cast<std::size_t>(row * kColumns + column)];
    }
    double statistic = 0;
    int cells = 0;
    double all = 0;
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column) {
            // The density is the same around the normal, so a cell takes points along its height only.
            constexpr int kPoints = 64;
            double expected = 0;
            for (int k = 0; k < kPoints; ++k) {
                const double z = 2 * (row + (k + 0.5) / kPoints) / kRows - 1;
                const double around = 2 * std::numbers::pi * (column + 0.5) / kColumns;
                const double r = std::sqrt(1 - z * z);
                expected += density(diffuse, {r * std::cos(around), r * std::sin(around), z}) / kPoints;
            }
            expected *= 4 * std::numbers::pi / (kRows * kColumns);
            all += expected;
            const double count = counts[static_cast<std::size_t>(row * kColumns + column)];
            if (expected == 0) {
                EXPECT_EQ(count, 0);
                continue;
            }
            const double difference = count - kDraws * expected;
            statistic += difference * difference / (kDraws * expected);
            ++cells;
        }
    }
    EXPECT_NEAR(all, 1, 1e-12);
    EXPECT_EQ(cells, kRows * kColumns / 2);
    EXPECT_FALSE(is_significant(p_value_of_chi_square(statistic, cells - 1), 1));
}

/// A fuzzy mirror adds a point of a sphere to the mirrored direction. How many of these points turn it by less than an
/// angle must be the integral of the density up to there.
TEST(BsdfDensity, OfAFuzzyMirrorIsThatOfThePointsOfItsSphere) {
    for (const double fuzz : {1e-3, 0.1, 0.5, 0.99, 1.0}) {
        // Angles a with sin a = fuzz sin phi, which leaves nothing singular: phi up to a quarter turn.
        constexpr int kSteps = 2000;
        const double step = std::numbers::pi / 2 / kSteps;
        const Vec3<double> mirrored(0, 0, 1);
        double integral = 0;
        for (int i = 0; i < kSteps; ++i) {
            const double phi = (i + 0.5) * step;
            const double sine = fuzz * std::sin(phi);
            const double cosine = std::sqrt(1 - sine * sine);
            const double width = fuzz * std::cos(phi) / cosine * step;
            integral += fuzzy_density<double>(mirrored, fuzz, {sine, 0, cosine}) * 2 * std::numbers::pi * sine * width;
            if (i % 200 != 199) continue;
            const double edge = fuzz * std::sin(phi + step / 2);
            // Points of a sphere lie evenly along its axis.
            constexpr int kPoints = 200'000;
            int inside = 0;
            for (int k = 0; k < kPoints; ++k) {
                const double c = (2 * k + 1.0) / kPoints - 1;
                const double x = fuzz * std::sqrt(1 - c * c), z = 1 + fuzz * c;
                inside += x < edge * std::hypot(x, z) ? 1 : 0;
            }
            EXPECT_NEAR(integral, inside / double{kPoints}, 2e-4) << fuzz << ' ' << phi;
        }
        EXPECT_NEAR(integral, 1, 1e-5) << fuzz;
        EXPECT_EQ(fuzzy_density<double>(mirrored, fuzz, {0, 0, -1}), 0);
    }
}

TEST(BsdfValue, IsWhatASampleIsWeightedByTimesItsDensity) {
    RandomInputs random(12);
    for (const Surface& surface :
         {surface_of(Kind::Diffuse), surface_of(Kind::Metal, 0.2), surface_of(Kind::Metal, 1)}) {
        for (int i = 0; i < 1000; ++i) {
            const BsdfSample<double> drawn = sample(surface, random);
            const double of_drawn = density(surface, drawn.direction);
            ASSERT_EQ(of_drawn > 0, !drawn.is_absorbed);
            if (drawn.is_absorbed) continue;
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(value(surface, drawn.direction)[k] / of_drawn, kColour[k], 1e-12);
        }
    }
}

TEST(BsdfValue, IsNothingBelowTheSurfaceNorForWhatHasNoDensity) {
    RandomInputs random(13);
    const Surface others[] = {surface_of(Kind::Emissive), surface_of(Kind::Dielectric, 1.5), surface_of(Kind::Metal)};
    for (int i = 0; i < 1000; ++i) {
        const Vec3<double> d = random.direction<double>();
        if (d[2] <= 0) {
            EXPECT_EQ(value(surface_of(Kind::Diffuse), d).norm(), 0);
            EXPECT_EQ(value(surface_of(Kind::Metal, 1), d).norm(), 0);
        }
        for (const Surface& surface : others) {
            EXPECT_EQ(density(surface, d), 0);
            EXPECT_EQ(value(surface, d).norm(), 0);
        }
    }
}

}  // namespace
}  // namespace raypool::test
