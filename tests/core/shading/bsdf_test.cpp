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

Vec3<double> sampled(const Surface& surface, RandomInputs& random) {
    const auto [u, v] = random.unit_square<double>();
    const Vec3<double> down = Vec3<double>(0.6, 0, -0.8);
    return sample_bsdf<kEverything, double, Splitting::Off>(ground(), surface, down, {u, v, 0.5, 0.5}, false).direction;
}

double density(const Surface& surface, const Vec3<double>& direction) {
    return bsdf_density<kEverything, double>(ground(), surface, direction);
}

Vec3<double> value(const Surface& surface, const Vec3<double>& direction) {
    return bsdf_value<kEverything, double>(ground(), surface, kColour, direction);
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

TEST(BsdfValue, IsWhatASampleIsWeightedByTimesItsDensity) {
    const Surface diffuse = surface_of(Kind::Diffuse);
    RandomInputs random(12);
    for (int i = 0; i < 1000; ++i) {
        const Vec3<double> d = sampled(diffuse, random);
        ASSERT_GT(density(diffuse, d), 0);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(value(diffuse, d)[k] / density(diffuse, d), kColour[k], 1e-12);
    }
}

TEST(BsdfValue, IsNothingBelowTheSurfaceNorForWhatHasNoDensity) {
    RandomInputs random(13);
    const Surface others[] = {surface_of(Kind::Emissive), surface_of(Kind::Dielectric, 1.5), surface_of(Kind::Metal),
                              surface_of(Kind::Metal, 0.5)};
    for (int i = 0; i < 1000; ++i) {
        const Vec3<double> d = random.direction<double>();
        if (d[2] <= 0) {
            EXPECT_EQ(value(surface_of(Kind::Diffuse), d).norm(), 0);
        }
        for (const Surface& surface : others) {
            EXPECT_EQ(density(surface, d), 0);
            EXPECT_EQ(value(surface, d).norm(), 0);
        }
    }
}

}  // namespace
}  // namespace raypool::test
