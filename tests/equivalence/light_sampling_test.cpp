// One image with light sampling: every engine, every rung of the ladder, any threads and capacity, split or not.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "tests/equivalence/every_nth.h"
#include "tests/equivalence/same_image.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

namespace raypool {
namespace {

class LightSampledImage : public testing::TestWithParam<const char*> {
  protected:
    template <class Scalar>
    static void expect_one_image(EveryNth& some, LightSampling sampling, int split_depth, Sampler sampler,
                                 bool roulette) {
        const std::string name = GetParam();
        const CompiledScene<Scalar> scene = compile<Scalar>(small_scene(name, 20));
        RenderSettings settings;
        settings.end_sample = 4;
        settings.light_sampling = sampling;
        settings.split_depth = split_depth;
        settings.sampler = sampler;
        settings.roulette = roulette;
        const Rendered expected = render(recursive::RecursiveEngine(), scene, settings);
        EXPECT_GT(expected.report.total(&ThreadReport::shadow_rays), 0);
        const auto check = [&](const Engine& engine, const RenderSettings& how, const std::string& what) {
            if (!some.takes_next()) return;
            const Rendered got = render(engine, scene, how);
            EXPECT_TRUE(same_image("light_sampled_" + name, expected, got, what));
            EXPECT_EQ(got.report.total(&ThreadReport::shadow_rays), expected.report.total(&ThreadReport::shadow_rays))
                << what;
        };
        for (const int threads : {1, 3}) {
            settings.threads = threads;
            check(recursive::RecursiveEngine(), settings, fmt::format("recursive {}", threads));
            check(recursive::IterativeEngine(), settings, fmt::format("iterative {}", threads));
            for (const wavefront::Rung& rung : wavefront::ladder(threads)) {
                for (const std::int64_t capacity : {17, 8192}) {
                    wavefront::PoolSettings pool = rung.pool;
                    pool.capacity = capacity;
                    check(wavefront::WavefrontEngine(pool), settings,
                          fmt::format("{} {} {}", rung.name, threads, capacity));
                }
            }
            RenderSettings counted = settings;
            counted.count_work = true;
            check(recursive::RecursiveEngine(), counted, "recursive, counted");
            check(wavefront::WavefrontEngine({}), counted, "pool, counted");
        }
    }
};

TEST_P(LightSampledImage, IsTheSameInEveryEngine) {
    EveryNth some(5);
    for (const LightSampling sampling : {LightSampling::Light, LightSampling::Mis}) {
        expect_one_image<float>(some, sampling, 0, Sampler::Independent, false);
        expect_one_image<float>(some, sampling, 2, Sampler::Sobol, true);
    }
    expect_one_image<double>(some, LightSampling::Mis, 0, Sampler::Independent, false);
}

/// Code that has light sampling makes today's image where it is off.
TEST_P(LightSampledImage, IsThatWithoutLightSamplingWhereItIsOff) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 20));
    RenderSettings settings;
    settings.end_sample = 4;
    const Rendered expected = render(recursive::RecursiveEngine(), scene, settings);
    settings.count_work = true;
    EXPECT_EQ(render(recursive::RecursiveEngine(), scene, settings).hash(), expected.hash());
    EXPECT_EQ(render(wavefront::WavefrontEngine({}), scene, settings).hash(), expected.hash());
    EXPECT_EQ(expected.report.total(&ThreadReport::shadow_rays), 0);
}

/// Code that counts and splits has light sampling whether there are lights or not.
TEST(LightSamplingWithoutLights, IsNone) {
    const CompiledScene<float> scene = compile<float>(small_scene("glass_stack", 20));
    RenderSettings settings;
    settings.end_sample = 4;
    for (const int split_depth : {0, 2}) {
        settings.split_depth = split_depth;
        settings.light_sampling = LightSampling::None;
        const Rendered expected = render(recursive::RecursiveEngine(), scene, settings);
        settings.light_sampling = LightSampling::Mis;
        for (const bool counts : {false, true}) {
            settings.count_work = counts;
            EXPECT_EQ(render(recursive::RecursiveEngine(), scene, settings).hash(), expected.hash());
            EXPECT_EQ(render(wavefront::WavefrontEngine({}), scene, settings).hash(), expected.hash());
        }
        settings.count_work = false;
    }
}

INSTANTIATE_TEST_SUITE_P(Equivalence, LightSampledImage,
                         testing::Values("cornell", "mirror_corridor", "textures", "caustic", "sky_image", "solids",
                                         "smooth", "instances"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace raypool
