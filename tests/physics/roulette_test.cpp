// Russian roulette and the limit of depth: the first changes no expectation, the second no more than its bound says.

#include <gtest/gtest.h>

#include "core/shading/shade.h"
#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

using Precisions = testing::Types<float, double>;

template <class Scalar>
class Roulette : public testing::Test {};
TYPED_TEST_SUITE(Roulette, Precisions);

/// A path of the greatest channel q goes on for exactly the numbers that make its expectation what it was.
TYPED_TEST(Roulette, KeepsTheExpectationOfEveryThroughputToTheLastStep) {
    constexpr double kStep = 0x1p-24;  // of random numbers
    for (const double most : {0.999999999, 0.73, 0.5, 0.25, 0.1, 1e-3, 1e-6, 1.5 * kStep, kStep, 0.3 * kStep}) {
        const auto last = static_cast<TypeParam>((std::ceil(most / kStep) - 1) * kStep);
        const auto carried = vec3<TypeParam>(TypeParam(most / 4), TypeParam(most), TypeParam(0));
        for (const bool survives : {true, false}) {
            Vec3<TypeParam> throughput = carried;
            const TypeParam random = survives ? last : last + TypeParam(kStep);
            if (random >= 1) continue;  // then no number ends the path
            EXPECT_EQ(survives_roulette<TypeParam>(throughput, random, true), survives) << most;
            const double chance = static_cast<double>(last) + kStep;
            for (int i = 0; i < 3; ++i)
                EXPECT_NEAR(chance * static_cast<double>(throughput[i]), static_cast<double>(carried[i]),
                            3e-7 * static_cast<double>(carried[i]));
            EXPECT_LE(throughput.maxCoeff(), 1);
        }
    }
}

TYPED_TEST(Roulette, LeavesAloneWhoDoesNotPlayAndWhoCarriesAll) {
    Vec3<TypeParam> throughput = vec3<TypeParam>(0.25, 0.5, 0);
    EXPECT_TRUE(survives_roulette<TypeParam>(throughput, TypeParam(0.9), false));
    EXPECT_EQ(throughput, vec3<TypeParam>(0.25, 0.5, 0));
    throughput = vec3<TypeParam>(0, 0.5, 1);
    EXPECT_TRUE(survives_roulette<TypeParam>(throughput, TypeParam(0.9), true));
    EXPECT_EQ(throughput, vec3<TypeParam>(0, 0.5, 1));
}

template <class Scalar>
Rendered render_with(const Scene& scene, bool roulette, std::int64_t spp, std::int32_t depth, std::uint64_t seed = 0,
                     Sampler sampler = Sampler::Independent) {
    RenderSettings settings;
    settings.end_sample = spp;
    settings.depth = depth;
    settings.seed = seed;
    settings.roulette = roulette;
    settings.sampler = sampler;
    return render(recursive::IterativeEngine(), compile<Scalar>(scene), settings);
}

TYPED_TEST(Roulette, EndsNoPathOfAWhiteFurnace) {
    const Scene scene = small_scene("furnace", 32);
    EXPECT_EQ(render_with<TypeParam>(scene, true, 4, 1000).hash(),
              render_with<TypeParam>(scene, false, 4, 1000).hash());
}

/// The integrating sphere of furnace_test.cpp: a diffuse wall of albedo a, a shining port of the part f of it.
struct IntegratingSphere {
    static constexpr double kAlbedo = 0.99;
    static constexpr double kHeight = 0.9375;
    static constexpr double kPort = (1 - kHeight) / 2;
    TestScene scene{128, 128, Vector3d::Zero()};

    IntegratingSphere() {
        scene.sphere({0, 0, 0}, 1, scene.diffuse(kAlbedo));
        scene.plane({0, kHeight, 0}, {0, 1, 0}, scene.emitter(1));
        scene.look({0, 0, 0}, {0, -1, 0}, 60);
    }
    /// Of the wall, through paths of at most `depth` segments.
    static double radiance(std::int32_t depth) {
        const double q = kAlbedo * (1 - kPort);
        return kAlbedo * kPort * (1 - std::pow(q, depth - 1)) / (1 - q);
    }
};

TYPED_TEST(Roulette, GivesTheRadianceOfAnIntegratingSphereAtEveryDepth) {
    const IntegratingSphere sphere;
    for (const std::int32_t depth : {5, 50, 2000}) {
        for (const Sampler sampler : {Sampler::Independent, Sampler::Sobol}) {
            const Rendered played = render_with<TypeParam>(sphere.scene, true, 4, depth, 0, sampler);
            EXPECT_TRUE(mean_agrees(pixel_values(played), IntegratingSphere::radiance(depth))) << depth;
            EXPECT_EQ(played.report.statistics.clamped, 0);
            if (depth < 50) continue;
            const Rendered whole = render_with<TypeParam>(sphere.scene, false, 4, depth, 0, sampler);
            EXPECT_LT(played.report.segments(), 0.98 * static_cast<double>(whole.report.segments()));
        }
    }
}

/// All light of the scenes, with and without, by one test over all pixels: they follow the same numbers, so that what
/// differs is only what roulette ended and what it made brighter.
TYPED_TEST(Roulette, ChangesNoExpectationOfAScene) {
    Scene grey_furnace = small_scene("furnace", 64);
    for (Texture& texture : grey_furnace.textures) texture.even *= 0.9;
    for (const Scene& scene : {small_scene("cornell", 64), grey_furnace, small_scene("paper", 96)}) {
        const Rendered whole = render_with<TypeParam>(scene, false, 16, 50);
        const Rendered played = render_with<TypeParam>(scene, true, 16, 50);
        EXPECT_NE(whole.hash(), played.hash()) << scene.name;
        EXPECT_LT(played.report.segments(), whole.report.segments()) << scene.name;
        std::vector<double> differences = pixel_values(played);
        const std::vector<double> expected = pixel_values(whole);
        for (std::size_t i = 0; i < differences.size(); ++i) differences[i] -= expected[i];
        EXPECT_TRUE(mean_agrees(differences, 0)) << scene.name;
    }
}

/// Both branches of a split play.
TYPED_TEST(Roulette, ChangesNoExpectationOfSplitPaths) {
    TestScene scene(48, 48, Vector3d::Constant(0.75));
    scene.sphere({0, 0, 0}, 3, scene.diffuse(0.5));  // a grey cavity around a shining pane and a ball of glass
    scene.sphere({0, 0, 0}, 1, scene.glass(1.5));
    scene.plane({0, 2, 0}, {0, 1, 0}, scene.emitter(1));
    scene.look({0, 0, 2.5}, {0, 0, 0}, 60);
    for (const int split_depth : {0, 3}) {
        std::vector<double> values[2];
        for (const bool roulette : {false, true}) {
            RenderSettings settings;
            settings.end_sample = 16;
            settings.split_depth = split_depth;
            settings.roulette = roulette;
            values[roulette ? 1 : 0] =
                pixel_values(render(recursive::IterativeEngine(), compile<TypeParam>(scene), settings));
        }
        EXPECT_NE(values[0], values[1]);
        for (std::size_t i = 0; i < values[0].size(); ++i) values[1][i] -= values[0][i];
        EXPECT_TRUE(mean_agrees(values[1], 0)) << split_depth;
    }
}

TEST(TruncationBound, HoldsForWhatAnIntegratingSphereLoses) {
    const IntegratingSphere sphere;
    const CompiledScene<float> scene = compile<float>(sphere.scene);
    EXPECT_EQ(scene.max_albedo, IntegratingSphere::kAlbedo);
    for (const std::int32_t depth : {1, 2, 10, 100, 1000}) {
        const double lost = IntegratingSphere::radiance(1 << 20) - IntegratingSphere::radiance(depth);
        EXPECT_GE(scene.truncation_bound(depth), lost) << depth;
        EXPECT_DOUBLE_EQ(scene.truncation_bound(depth), std::pow(IntegratingSphere::kAlbedo, depth));
    }
}

/// White walls under a sky seen through a small hole: what is cut off is nearly all that there is.
TEST(TruncationBound, IsTheWholeLightOfGlassAndNothingOfAnEmptyScene) {
    TestScene scene(4, 4, Vector3d::Constant(3));
    EXPECT_EQ(compile<float>(scene).truncation_bound(1), 0);
    EXPECT_EQ(compile<float>(scene).truncation_bound(0), 3);
    scene.sphere({0, 0, 0}, 1, scene.diffuse(0.5));
    EXPECT_DOUBLE_EQ(compile<double>(scene).truncation_bound(2), 0.75);
    scene.sphere({3, 0, 0}, 1, scene.glass(1.5));
    EXPECT_EQ(compile<float>(scene).truncation_bound(100), 3);
}

}  // namespace
}  // namespace raypool
