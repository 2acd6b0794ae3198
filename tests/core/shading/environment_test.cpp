/// The image around a scene: which texel a direction sees, and that directions are drawn at the density that is said.
#include "core/shading/environment.h"

#include <numeric>

#include <gtest/gtest.h>

#include "core/math/random.h"
#include "core/scene/emission.h"
#include "core/shading/compiled_scene.h"
#include "tests/core/math/lane_agreement.h"
#include "tests/physics/test_scene.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

/// A scene that is nothing but an image.
TestScene image_scene(std::shared_ptr<const Image> image, double rotation_degrees = 0, double scale = 1) {
    TestScene scene(1, 1, Vector3d::Zero());
    scene.background.image = std::move(image);
    scene.background.rotation_degrees = rotation_degrees;
    scene.background.scale = scale;
    return scene;
}

/// Texels of every brightness, some of them and the third row black.
std::shared_ptr<const Image> uneven(std::int64_t height, std::uint64_t seed = 1) {
    RandomInputs random(seed);
    return image_of(height, [&](std::int64_t, std::int64_t row) {
        const bool is_black = row == 2 || random.one_in(3);
        return is_black ? Vector3d(0, 0, 0) : Vector3d(std::exp(random.uniform(-3, 3)), 0.2, 0);
    });
}
/// A sun of 10^6 in a dim sky.
std::shared_ptr<const Image> sun(std::int64_t height) {
    return image_of(height, [&](std::int64_t column, std::int64_t row) {
        return Vector3d::Constant(row == height / 4 && column == height / 3 ? 1e6 : 0.25);
    });
}

template <class Scalar>
double chance_of_texel(const CompiledScene<Scalar>& compiled, const Image& image, std::size_t texel) {
    const double density = compiled.environment.texels[texel].value[EnvironmentTexel<Scalar>::kDensity];
    return density * texel_solid_angle(image, static_cast<std::int64_t>(texel) / image.width);
}

template <class Scalar>
class EnvironmentImage : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(EnvironmentImage, Precisions);

TYPED_TEST(EnvironmentImage, HasDensitiesThatAddUpToOneAndFollowItsBrightness) {
    for (const auto& image : {uneven(1), uneven(5), uneven(64), sun(32), sun(300)}) {
        const CompiledScene<TypeParam> compiled = compile<TypeParam>(image_scene(image, 12, 0.5));
        EXPECT_TRUE(compiled.features.lights && compiled.features.environment);
        std::vector<double> power;
        for (std::int64_t i = 0; i < image->width * image->height; ++i) {
            const float* p = image->pixel(i % image->width, i / image->width);
            power.push_back((double{p[0]} + p[1] + p[2]) * texel_solid_angle(*image, i / image->width));
        }
        const double sum = std::accumulate(power.begin(), power.end(), 0.0);
        double chances = 0;
        for (std::size_t i = 0; i < power.size(); ++i) {
            const double chance = chance_of_texel(compiled, *image, i);
            chances += chance;
            EXPECT_NEAR(chance, power[i] / sum, 1e-4 * power[i] / sum + 1e-6) << i;
            EXPECT_TRUE(power[i] > 0 || chance == 0) << i;
        }
        EXPECT_NEAR(chances, 1, 1e-6);
    }
}

TEST(AliasTable, CountsTheRandomNumbersThatDrawEachEntry) {
    for (const std::size_t count : {1U, 3U, 256U, 1000U, 16384U}) {
        std::vector<double> drawn(count);
        for (int step = 0; step < 1 << 24; ++step)
            drawn[static_cast<std::size_t>(
                draw_entry<float>(static_cast<float>(step) * 0x1p-24F, static_cast<float>(count)))] += 0x1p-24;
        EXPECT_EQ(draw_chances<float>(count), drawn) << count;
    }
}

TEST(AliasTable, NeverChoosesWhatHasNoShare) {
    RandomInputs random(5);
    for (const std::size_t count : {2U, 7U, 1000U, 16384U}) {
        std::vector<double> shares(count);
        for (double& share : shares) share = random.one_in(3) ? 0 : std::exp(random.uniform(-30, 30));
        shares[count / 2] = 1;
        const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
        for (double& share : shares) share /= sum;
        const std::vector<double> chances = alias_chances(alias_table(shares), draw_chances<float>(count));
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_NEAR(chances[i], shares[i], 2e-7 + 1e-3 * shares[i]);
            if (shares[i] == 0) {
                EXPECT_EQ(chances[i], 0);
            }
        }
    }
}

template <class Real>
EnvironmentSample<Real> drawn(const EnvironmentView<ScalarOf<Real>>& environment, const Uint32<Real>& sample) {
    const PathKey<Real> key{Uint32<Real>(7U), sample};
    const auto block = [&](RandomPurpose purpose) {
        return random_block<Real>(key, Uint32<Real>(0U), purpose, random_seed(0));
    };
    const std::array<Real, 4> place = block(RandomPurpose::Light);
    return sample_environment<Real>(environment, block(RandomPurpose::Environment), place[1], place[2]);
}

TYPED_TEST(EnvironmentImage, IsDrawnAtItsDensities) {
    constexpr std::uint32_t kCount = 400'000;
    for (const auto& image : {uneven(1, 4), uneven(3), uneven(16), sun(32)}) {
        const CompiledScene<TypeParam> compiled = compile<TypeParam>(image_scene(image, 123));
        const EnvironmentView<TypeParam>& environment = compiled.environment;
        std::vector<double> counts(environment.texels.size());
        int strays = 0;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const EnvironmentSample<TypeParam> sample = drawn<TypeParam>(environment, i);
            const auto texel = static_cast<std::size_t>(sample.texel_id);
            ASSERT_LT(texel, counts.size());
            ++counts[texel];
            ASSERT_NEAR(sample.direction.norm(), 1, 1e-6);
            ASSERT_EQ(sample.density, environment.texels[texel].value[EnvironmentTexel<TypeParam>::kDensity]);
            ASSERT_EQ(sample.radiance[0], environment.texels[texel].value[0]);
            strays += environment_texel<TypeParam>(environment, sample.direction) != sample.texel_id ? 1 : 0;
        }
        EXPECT_LT(strays, 1e-4 * kCount) << "edges are met to rounding";

        double statistic = 0;
        double rest = kCount, rest_expected = kCount;  // of texels too rare for a cell of their own
        int cells = 0;
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const double expected = kCount * chance_of_texel(compiled, *image, i);
            if (expected == 0) {
                EXPECT_EQ(counts[i], 0) << i;
            }
            if (expected < 8) continue;
            statistic += (counts[i] - expected) * (counts[i] - expected) / expected;
            rest -= counts[i], rest_expected -= expected, ++cells;
        }
        if (rest_expected > 8) statistic += (rest - rest_expected) * (rest - rest_expected) / rest_expected, ++cells;
        ASSERT_GE(cells, 2);
        EXPECT_FALSE(is_significant(p_value_of_chi_square(statistic, cells - 1), 8)) << image->height;
    }
}

/// Of an image that is one colour all directions are alike.
TYPED_TEST(EnvironmentImage, IsDrawnEvenlyWithinItsTexels) {
    for (const std::int64_t height : {1, 2, 5}) {
        const auto image = image_of(height, [](std::int64_t, std::int64_t) { return Vector3d(1, 1, 1); });
        const CompiledScene<TypeParam> compiled = compile<TypeParam>(image_scene(image, 33));
        Grid grid;
        for (std::uint32_t i = 0; i < 400'000; ++i) {
            const Vec3<TypeParam> d = drawn<TypeParam>(compiled.environment, i).direction;
            grid.add(std::atan2(d[2], d[0]) / (2 * std::numbers::pi) + 0.5, (d[1] + 1) / 2);
        }
        EXPECT_FALSE(is_significant(grid.p_value(), 6)) << height;
    }
}

/// -z lies in the middle of the image, +x at three quarters of its width, +y at its top; a rotation takes -z to -x.
TYPED_TEST(EnvironmentImage, LiesAroundTheSceneAsDocumented) {
    constexpr std::int64_t kHeight = 45;
    const auto black = image_of(kHeight, [](std::int64_t, std::int64_t) { return Vector3d(0, 0, 0); });
    const auto texel = [&](double rotation, const Vector3d& direction) {
        const CompiledScene<TypeParam> compiled = compile<TypeParam>(image_scene(black, rotation));
        EXPECT_TRUE(compiled.features.environment && !compiled.features.lights);
        EXPECT_TRUE(compiled.environment.rows.empty());
        const Vector3d d = direction.normalized();
        return environment_texel<TypeParam>(compiled.environment, d.cast<TypeParam>());
    };
    const auto column = [&](double rotation, const Vector3d& d) { return texel(rotation, d) % (2 * kHeight); };
    EXPECT_EQ(texel(0, {0.001, 0.001, -1}), 22 * 90 + 45);
    EXPECT_EQ(texel(0, {1, 0.001, 0.001}), 22 * 90 + 67);
    EXPECT_EQ(texel(0, {-1, 0.001, 0.001}), 22 * 90 + 22);
    EXPECT_EQ(column(0, {0.001, 0, 1}), 89);
    EXPECT_EQ(column(0, {-0.001, 0, 1}), 0);
    EXPECT_EQ(texel(0, {0, 1, 0.01}) / 90, 0);
    EXPECT_EQ(texel(0, {0, -1, 0.01}) / 90, 44);
    EXPECT_EQ(column(90, {-1, 0, -0.001}), 45);
    EXPECT_EQ(column(-270, {-1, 0, -0.001}), 45);
    EXPECT_EQ(column(360, {0.001, 0, -1}), 45);

    RandomInputs random(2);
    int apart = 0;
    for (int i = 0; i < 1000; ++i) {
        const double rotation = random.uniform(-360, 360);
        const Vector3d d = random.direction<double>();
        const double turns = std::atan2(-d.x(), d.z()) / (2 * std::numbers::pi) + rotation / 360;
        const double x = (turns - std::floor(turns)) * 2 * kHeight;
        const double y = std::acos(d.y()) / std::numbers::pi * kHeight;
        apart += texel(rotation, d) != static_cast<int>(y) * 2 * kHeight + static_cast<int>(x) ? 1 : 0;
    }
    EXPECT_LE(apart, 1) << "edges are met to rounding";
}

template <class Scalar, class... Reals>
void expect_lanes_agree_on_images() {
    for (const auto& image : {uneven(1, 4), uneven(37), sun(64)}) {
        const CompiledScene<Scalar> compiled = compile<Scalar>(image_scene(image, 200));
        expect_lanes_agree_for<Scalar, Reals...>(
            kInputs / 8,
            [&](RandomInputs& random, Row<Scalar>& row) {
                row.vec(random.direction<Scalar>());
                row.word(static_cast<std::uint32_t>(random.below(1 << 20)));
            },
            [&]<class Real>(Arguments<Real>& in, Results<Real>& out) {
                const EnvironmentSight<Real> seen = see_environment<Real>(compiled.environment, in.vec());
                out(seen.radiance), out(seen.density);
                const EnvironmentSample<Real> sample = drawn<Real>(compiled.environment, in.word());
                out(sample.direction), out(sample.radiance), out(sample.density), out(to_real<Real>(sample.texel_id));
            });
    }
}
TEST(EnvironmentAgreement, HoldsInFloat) {
    expect_lanes_agree_on_images<float, stdx::native_simd<float>, Wide<float, kTreeWidth<float>>>();
}
TEST(EnvironmentAgreement, HoldsInDouble) {
    expect_lanes_agree_on_images<double, stdx::native_simd<double>>();
}

/// By what it sends through the sphere around the shapes, against what lamps send out.
TEST(EnvironmentPower, IsThatOfALampAroundTheShapes) {
    TestScene scene(1, 1, Vector3d::Zero());
    scene.sphere({1, 2, 3}, 2, scene.emitter(0.5));
    scene.background.image = image_of(8, [](std::int64_t, std::int64_t) { return Vector3d(2, 3, 4); });
    scene.background.scale = 0.5;
    const EmittedPower power(scene);
    EXPECT_NEAR(power.of(scene.background) / power.of(scene.spheres[0]), 3 * 3, 1e-9);  // 3 times as bright and wide^2
    const CompiledScene<double> compiled = compile<double>(scene);
    ASSERT_EQ(compiled.lights.size(), 2U);
    EXPECT_NEAR(compiled.environment.texels[0].value[EnvironmentTexel<double>::kDensity] * 4 * std::numbers::pi, 0.9,
                1e-5);
    EXPECT_NEAR(compiled.light_weights[0], 0.1, 1e-6);
    EXPECT_EQ(compiled.max_radiance, 2);
}

}  // namespace
}  // namespace raypool::test
