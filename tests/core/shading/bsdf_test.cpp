/// What a material samples against what it says of a given direction.
#include "core/shading/bsdf.h"

#include <numbers>

#include <gtest/gtest.h>

#include "core/scene/features.h"
#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

enum class Kind : std::uint8_t { Diffuse, Emitter, Glass, Metal };

/// A surface of one material, its normal up, met from above.
Interaction<double> surface_of(Kind kind, double parameter = 0) {
    Interaction<double> met{};
    met.parameter = parameter;
    met.point.normal = met.point.outward = {0, 0, 1};
    met.point.is_front = true;
    met.colour = {0.9, 0.5, 0.1};
    met.is_emitter = kind == Kind::Emitter;
    met.is_glass = kind == Kind::Glass;
    met.is_metal = kind == Kind::Metal;
    return met;
}

Vec3<double> sampled(const Interaction<double>& met, RandomInputs& random) {
    const auto [u, v] = random.unit_square<double>();
    const Vec3<double> down = Vec3<double>(0.6, 0, -0.8);
    return sample_bsdf<kEverything, double, Splitting::Off>(met, down, {u, v, 0.5, 0.5}, false).direction;
}

TEST(BsdfDensity, IsThatOfTheSampledDirections) {
    // Cells of equal solid angle over the whole sphere, that below the surface too.
    constexpr int kRows = 20;
    constexpr int kColumns = 8;
    const Interaction<double> met = surface_of(Kind::Diffuse);
    std::vector<double> counts(kRows * kColumns);
    RandomInputs random(11);
    for (int i = 0; i < kDraws; ++i) {
        const Vec3<double> d = sampled(met, random);
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
                expected += bsdf_density<double>(met, {r * std::cos(around), r * std::sin(around), z}) / kPoints;
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
    const Interaction<double> met = surface_of(Kind::Diffuse);
    RandomInputs random(12);
    for (int i = 0; i < 1000; ++i) {
        const Vec3<double> d = sampled(met, random);
        const double density = bsdf_density<double>(met, d);
        ASSERT_GT(density, 0);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(bsdf_value<double>(met, d)[k] / density, met.colour[k], 1e-12);
    }
}

TEST(BsdfValue, IsNothingBelowTheSurfaceNorForWhatHasNoDensity) {
    RandomInputs random(13);
    const Interaction<double> others[] = {surface_of(Kind::Emitter), surface_of(Kind::Glass, 1.5),
                                          surface_of(Kind::Metal), surface_of(Kind::Metal, 0.5)};
    for (int i = 0; i < 1000; ++i) {
        const Vec3<double> d = random.direction<double>();
        if (d[2] <= 0) {
            EXPECT_EQ(bsdf_value<double>(surface_of(Kind::Diffuse), d).norm(), 0);
        }
        for (const Interaction<double>& met : others) {
            EXPECT_EQ(bsdf_density<double>(met, d), 0);
            EXPECT_EQ(bsdf_value<double>(met, d).norm(), 0);
        }
    }
}

}  // namespace
}  // namespace raypool::test
