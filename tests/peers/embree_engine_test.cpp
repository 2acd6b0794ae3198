// Embree's traversal with our physics makes the image of every engine, to the last bit.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "bench/peers/embree_engine.h"
#include "bench/peers/embree_scene.h"
#include "core/base/error.h"
#include "core/scene/builtin_scenes.h"
#include "recursive/tracer.h"
#include "tests/equivalence/same_image.h"

namespace raypool {
namespace {

using peers::EmbreeEngine;
using peers::EmbreeRays;

const EmbreeEngine kSingle(EmbreeRays::Single);
const EmbreeEngine kPacket(EmbreeRays::Packet);
const std::vector<const Engine*> kEngines{&kSingle, &kPacket};

/// Renders by both kinds of rays and asks for the image of recursion.
void expect_same(const std::string& name, const CompiledScene<float>& scene, const RenderSettings& settings) {
    RenderSettings plain = settings;
    plain.threads = 1;
    plain.schedule = {};
    const Rendered expected = render(recursive::IterativeEngine(), scene, plain);
    for (const Engine* engine : kEngines) {
        const Rendered got = render(*engine, scene, settings);
        const std::string how = fmt::format("{}, {} threads", engine->name(), settings.threads);
        EXPECT_TRUE(same_image("embree_" + name, expected, got, how));
        EXPECT_EQ(got.report.segments(), expected.report.segments()) << how;
        EXPECT_EQ(got.report.paths(), expected.report.paths()) << how;
    }
}

RenderSettings settings_of(std::int64_t spp) {
    RenderSettings settings;
    settings.end_sample = spp;
    return settings;
}

class EmbreeEngineOfScene : public testing::TestWithParam<std::string> {};

TEST_P(EmbreeEngineOfScene, MakesTheImageOfRecursion) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 120));
    expect_same(GetParam(), scene, settings_of(8));
}

TEST_P(EmbreeEngineOfScene, MakesItWithAnyNumberOfThreadsAndAnyCutOfTheImage) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 33));
    RenderSettings settings = settings_of(3);
    for (const int threads : {1, 2, 7}) {
        settings.threads = threads;
        settings.schedule = {LoopSchedule::Kind::Balanced, 0};
        expect_same(GetParam(), scene, settings);
        for (const auto kind : {LoopSchedule::Kind::Dynamic, LoopSchedule::Kind::Tasks}) {
            settings.schedule = {kind, 1};
            settings.grain = {Grain::Kind::Tile, 8};
            expect_same(GetParam(), scene, settings);
        }
    }
}

TEST_P(EmbreeEngineOfScene, MakesItByTheRulesOfEveryPath) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 40));
    RenderSettings settings = settings_of(4);
    for (const Sampler sampler : {Sampler::Independent, Sampler::Sobol}) {
        for (const bool roulette : {false, true}) {
            for (const std::int32_t depth : {0, 1, 2, 200}) {
                settings.sampler = sampler;
                settings.roulette = roulette;
                settings.depth = depth;
                expect_same(GetParam(), scene, settings);
            }
        }
    }
}

std::vector<std::string> scene_names() {
    std::vector<std::string> names{"textures"};
    for (const BuiltinSceneText& scene : builtin_scene_texts()) names.emplace_back(scene.name);
    return names;
}
INSTANTIATE_TEST_SUITE_P(BuiltIn, EmbreeEngineOfScene, testing::ValuesIn(scene_names()),
                         [](const auto& info) { return info.param; });

/// Finds each hit by our trees and by Embree, and counts those that differ.
struct BothHits {
    const peers::EmbreeScene* embree;
    std::int64_t* differing;

    template <Features features, class Scalar, class Work>
    Hit<Scalar> closest(const CompiledScene<Scalar>& scene, const Ray<Scalar>& ray, std::int32_t leaving_id,
                        Work& work) const {
        const Hit<Scalar> ours = closest_hit<features>(scene, ray, leaving_id, work);
        const Hit<Scalar> theirs = peers::closest_hit<features>(*embree, scene, ray, leaving_id);
        if (ours.t != theirs.t || ours.primitive_id != theirs.primitive_id) ++*differing;
        return ours;
    }
};

struct HitCount {
    std::int64_t differing = 0;
    std::int64_t all = 0;
};

HitCount count_hits(const Scene& described, std::int64_t spp) {
    const CompiledScene<float> scene = compile<float>(described);
    const peers::EmbreeScene embree(scene, peers::ShapeFunctions::make<kEverything, float>());
    HitCount count;
    recursive::Tracer<kEverything, float, NoTestCount, Splitting::Off, recursive::Rules::Any, BothHits> tracer(
        scene, {}, FixedPoint::make(spp, scene.max_radiance), {&embree, &count.differing});
    for (std::int64_t y = 0; y < scene.height; ++y)
        for (std::int64_t x = 0; x < scene.width; ++x)
            for (std::int64_t s = 0; s < spp; ++s) tracer.sample<recursive::Form::Iterative>(x, y, s);
    count.all = tracer.segments();
    return count;
}

TEST(EmbreeHits, Counted) {
    for (const std::string& name : scene_names()) {
        const HitCount count = count_hits(small_scene(name, 200), 16);
        fmt::print("{}: {} of {} hits differ\n", name, count.differing, count.all);
    }
    for (const char* file : {"/tmp/gen_s10k.json", "/tmp/gen_q10k.json", "/tmp/gen_m10k.json", "/tmp/gen_s100k.json"}) {
        Scene scene = read_scene(file);
        scene.height = scene.height * 200 / scene.width; scene.width = 200;
        const HitCount count = count_hits(scene, 8);
        fmt::print("{}: {} of {} hits differ\n", file, count.differing, count.all);
    }
}

}  // namespace
}  // namespace raypool
