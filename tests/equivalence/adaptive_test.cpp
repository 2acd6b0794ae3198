/// Adaptive renders are one image too: every engine, thread count, pool and accumulator makes the same passes.
#include "core/runtime/adaptive.h"

#include <gtest/gtest.h>

#include <tuple>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/runtime/settings_text.h"
#include "tests/equivalence/every_nth.h"
#include "tests/small_render.h"
#include "wavefront/engine.h"

namespace raypool {
namespace {

using namespace wavefront;

struct Adapted {
    std::string hash;
    std::vector<std::int32_t> sample_counts;
    std::int64_t paths;
    bool operator==(const Adapted&) const = default;
};

template <class Scalar>
Adapted adapt(const Engine& engine, const CompiledScene<Scalar>& scene, const RenderSettings& settings, double error) {
    Framebuffer framebuffer(scene.width, scene.height, fixed_point(scene, settings, settings.end_sample),
                            Halves::Apart);
    AdaptiveReport adaptive;
    const RenderReport report = render_adaptively(engine, scene, settings, error, framebuffer, adaptive);
    return {framebuffer.hash(), adaptive.sample_counts, report.paths()};
}

struct AdaptiveCase {
    const char* scene;
    double error;
};

class AdaptiveImage : public testing::TestWithParam<AdaptiveCase> {};

TEST_P(AdaptiveImage, IsTheSameForEveryEngineThreadCountAndPool) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam().scene, 28));
    RenderSettings settings;
    settings.end_sample = 80;
    const double error = GetParam().error;
    const Adapted expected = adapt(recursive::RecursiveEngine(), scene, settings, error);
    const auto [least, most] = std::minmax_element(expected.sample_counts.begin(), expected.sample_counts.end());
    ASSERT_LT(*least, *most) << "the case must adapt";

    EveryNth some(7);
    const auto check = [&](const Engine& engine, const std::string& what) {
        if (!some.takes_next()) return;
        EXPECT_EQ(adapt(engine, scene, settings, error), expected) << what << ", " << settings.threads << " threads";
    };
    check(recursive::IterativeEngine(), "iterative");
    for (const int threads : {1, 2, 7}) {
        settings.threads = threads;
        settings.schedule = {};
        check(recursive::RecursiveEngine(), "recursive");
        check(WavefrontEngine({}), "pool");
        settings.schedule = {LoopSchedule::Kind::Tasks, 2};
        check(WavefrontEngine({}), "pool, tasks");
        settings.schedule = {LoopSchedule::Kind::Dynamic, 1};
        for (const Grain& grain : {Grain{Grain::Kind::Line}, Grain{Grain::Kind::Pixel}, Grain{Grain::Kind::Tile, 5}}) {
            settings.grain = grain;
            check(recursive::RecursiveEngine(), "recursive, dynamic");
            for (const std::int64_t rays : {1, 17, 1000, 8192})
                check(WavefrontEngine({.capacity = rays}), fmt::format("{} rays", rays));
        }
        for (const auto& [refill, rays, accumulator] : {std::tuple{Refill::Drain, 200, Accumulator::AtomicInt64},
                                                        {Refill::Regenerate, 2000, Accumulator::PrivateInt64},
                                                        {Refill::Drain, 8192, Accumulator::AtomicPlanarInt64}})
            check(WavefrontEngine({.scope = PoolScope::Shared,
                                   .refill = refill,
                                   .accumulator = accumulator,
                                   .capacity = rays,
                                   .batch = 64}),
                  fmt::format("shared, accumulator {}", static_cast<int>(accumulator)));
        check(WavefrontEngine({.accumulator = Accumulator::OwnedPlanarInt64}), "planar");
        check(WavefrontEngine({.width = StageWidth::Scalar}), "scalar");
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, AdaptiveImage,
                         testing::Values(AdaptiveCase{"half_sky", 0.02}, AdaptiveCase{"paper", 0.04},
                                         AdaptiveCase{"cornell", 0.2}, AdaptiveCase{"glass_stack", 0.03}),
                         [](const auto& param) { return std::string(param.param.scene); });

TEST(AdaptiveRender, ThatIsStoppedTellsTheErrorOfWhatItHas) {
    const CompiledScene<float> scene = compile<float>(small_scene("half_sky", 16));
    RenderSettings settings;
    settings.end_sample = 80;
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(80, scene.max_radiance), Halves::Apart);
    AdaptivePlan plan({1e-6, scene.max_radiance, 80}, scene.width, scene.height);
    render_adaptively(recursive::RecursiveEngine(), scene, settings, plan, framebuffer, [] { return false; });
    EXPECT_EQ(plan.rounds(), 1);
    EXPECT_GT(plan.rmse(), 0);
    EXPECT_EQ(plan.rmse(), estimate_error(framebuffer, plan.sample_counts(), scene.max_radiance).rmse);
}

/// Samples that come in parts: of lights that are sampled, and of paths that are split.
TEST(AdaptiveEquivalence, HoldsForSamplesThatComeInParts) {
    EveryNth some(5);
    for (const AdaptiveCase& test : {AdaptiveCase{"caustic", 0.5}, {"cornell", 0.15}}) {
        const CompiledScene<float> scene = compile<float>(small_scene(test.scene, 16));
        for (const LightSampling sampling : {LightSampling::None, LightSampling::Light, LightSampling::Mis}) {
            for (const int split_depth : {0, 2}) {
                RenderSettings settings;
                settings.end_sample = 80;
                settings.light_sampling = sampling;
                settings.split_depth = split_depth;
                const Adapted expected = adapt(recursive::RecursiveEngine(), scene, settings, test.error);
                const auto check = [&](const Engine& engine, const std::string& what) {
                    if (!some.takes_next()) return;
                    EXPECT_EQ(adapt(engine, scene, settings, test.error), expected)
                        << test.scene << ' ' << to_string(sampling) << ' ' << split_depth << ' ' << what;
                };
                check(recursive::IterativeEngine(), "iterative");
                for (const int threads : {1, 3}) {
                    settings.threads = threads;
                    for (const std::int64_t rays : {17, 8192})
                        check(WavefrontEngine({.capacity = rays}), fmt::format("{} rays", rays));
                    check(WavefrontEngine({.scope = PoolScope::Shared,
                                           .accumulator = Accumulator::PrivateInt64,
                                           .capacity = 500,
                                           .batch = 64}),
                          "shared");
                }
            }
        }
    }
}

TEST(AdaptiveEquivalence, DoublePrecisionAgreesToo) {
    const CompiledScene<double> scene = compile<double>(small_scene("paper", 16));
    RenderSettings settings;
    settings.end_sample = 100;
    const Adapted expected = adapt(recursive::RecursiveEngine(), scene, settings, 0.03);
    settings.threads = 2;
    EXPECT_EQ(adapt(WavefrontEngine({}), scene, settings, 0.03), expected);
}

TEST(AdaptiveEquivalence, ChosenPixelsAreThoseOfAWholeRender) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 24));
    RenderSettings settings;
    settings.end_sample = 4;
    const Rendered whole = render(recursive::RecursiveEngine(), scene, settings);
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(scene.pixel_count()); i += 1 + i % 5) chosen.push_back(i);
    settings.pixels = &chosen;
    for (const auto& part :
         {render(recursive::RecursiveEngine(), scene, settings), render(WavefrontEngine({}), scene, settings)}) {
        std::size_t next = 0;
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(scene.pixel_count()); ++i) {
            const bool is_chosen = next < chosen.size() && chosen[next] == i;
            if (is_chosen) ++next;
            for (std::size_t k = 0; k < 3; ++k)
                ASSERT_EQ(part.framebuffer.sums()[3 * i + k], is_chosen ? whole.framebuffer.sums()[3 * i + k] : 0);
        }
        EXPECT_EQ(part.report.paths(), static_cast<std::int64_t>(4 * chosen.size()));
    }
}

TEST(AdaptiveRefusals, NameTheOption) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    RenderSettings settings;
    settings.end_sample = 100;
    EXPECT_THROW(adapt(WavefrontEngine({.scope = PoolScope::Shared, .accumulator = Accumulator::AtomicDouble}), scene,
                       settings, 0.1),
                 InputError);
}

}  // namespace
}  // namespace raypool
