/// The default schedule makes one image too: images so small that threads share their pixels, lists of pixels, second
/// halves, any pool and any accumulator.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/runtime/settings_text.h"
#include "tests/equivalence/every_nth.h"
#include "tests/small_render.h"
#include "wavefront/engine.h"

namespace raypool {
namespace {

using namespace wavefront;

struct NamedEngine {
    std::string name;
    std::unique_ptr<Engine> engine;
};
std::vector<NamedEngine> every_engine() {
    std::vector<NamedEngine> all;
    all.push_back({"recursive", std::make_unique<recursive::RecursiveEngine>()});
    all.push_back({"iterative", std::make_unique<recursive::IterativeEngine>()});
    const auto add = [&](const PoolSettings& pool) {
        all.push_back({fmt::format("scope {}, accumulator {}, {} rays, refill {}", static_cast<int>(pool.scope),
                                   static_cast<int>(pool.accumulator), pool.capacity, static_cast<int>(pool.refill)),
                       std::make_unique<WavefrontEngine>(pool)});
    };
    for (const Accumulator accumulator : {Accumulator::OwnedInt64, Accumulator::AtomicInt64, Accumulator::PrivateInt64,
                                          Accumulator::OwnedPlanarInt64, Accumulator::AtomicPlanarInt64})
        add({.accumulator = accumulator});
    for (const std::int64_t rays : {1, 30, 1000}) add({.capacity = rays});
    add({.refill = Refill::Drain, .capacity = 100});
    add({.camera = CameraStage::Staged, .sort = Sort::Material});
    add({.width = StageWidth::Scalar, .intersection = Intersection::Single});
    for (const Append append : {Append::InPlace, Append::Atomic, Append::PrefixSum})
        add({.scope = PoolScope::Shared,
             .append = append,
             .accumulator = Accumulator::AtomicInt64,
             .capacity = 500,
             .batch = 40});
    return all;
}

struct TinyCase {
    const char* name;
    const char* scene;
    std::int64_t width, height, spp;
    int split_depth;
    Halves halves;
};

class TinyImage : public testing::TestWithParam<TinyCase> {};

TEST_P(TinyImage, IsTheSameForEveryEngineThreadCountAndSchedule) {
    const TinyCase& test = GetParam();
    const CompiledScene<float> scene = compile<float>(small_scene(test.scene, test.width, test.height));
    const auto empty = [&] {
        return Framebuffer(scene.width, scene.height, FixedPoint::make(test.spp, scene.max_radiance), test.halves);
    };
    RenderSettings settings;
    settings.first_sample = 3;
    settings.end_sample = test.spp;
    settings.split_depth = test.split_depth;
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 0; i < scene.pixel_count(); i += 1 + i % 2) some.push_back(i);
    for (const std::vector<std::uint32_t>* pixels : {static_cast<std::vector<std::uint32_t>*>(nullptr), &some}) {
        settings.pixels = pixels;
        settings.threads = 1;
        Framebuffer expected = empty();
        const RenderReport alone = recursive::IterativeEngine().render(scene, settings, expected);
        EveryNth some(7);
        for (const NamedEngine& named : every_engine()) {
            for (const int threads : {1, 2, 7}) {
                for (const char* schedule : {"balanced", "tasks,1", "dynamic"}) {
                    if (!some.takes_next()) continue;
                    settings.threads = threads;
                    settings.schedule = parse_schedule(schedule);
                    Framebuffer sums = empty();
                    const RenderReport report = named.engine->render(scene, settings, sums);
                    ASSERT_EQ(sums.hash(), expected.hash())
                        << fmt::format("{}, {} threads, {}", named.name, threads, schedule);
                    EXPECT_EQ(report.paths(), alone.paths());
                    EXPECT_EQ(report.segments(), alone.segments());
                }
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes, TinyImage,
                         testing::Values(TinyCase{"pixel", "paper", 1, 1, 2000, 0, Halves::Together},
                                         TinyCase{"halves", "paper", 1, 1, 700, 0, Halves::Apart},
                                         TinyCase{"column", "cornell", 1, 6, 150, 0, Halves::Apart},
                                         TinyCase{"line", "paper", 300, 1, 6, 0, Halves::Together},
                                         TinyCase{"split", "glass_stack", 2, 2, 120, 2, Halves::Together},
                                         TinyCase{"sample", "paper", 9, 5, 4, 0, Halves::Together}),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace raypool
