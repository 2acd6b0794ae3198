// Embree's traversal with our physics makes the image of every engine, to the last bit.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bench/peers/embree_engine.h"
#include "bench/peers/embree_scene.h"
#include "core/base/error.h"
#include "core/image/cost_image.h"
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
        EXPECT_EQ(got.report.total(&ThreadReport::shadow_rays), expected.report.total(&ThreadReport::shadow_rays))
            << how;
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

TEST_P(EmbreeEngineOfScene, MakesItWithLightSampling) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 60));
    RenderSettings settings = settings_of(4);
    settings.threads = 2;
    for (const LightSampling sampling : {LightSampling::Light, LightSampling::Mis}) {
        settings.light_sampling = sampling;
        expect_same(GetParam(), scene, settings);
    }
}

std::vector<std::string> scene_names() {
    std::vector<std::string> names{"textures", "solids"};
    for (const BuiltinSceneText& scene : builtin_scene_texts()) names.emplace_back(scene.name);
    return names;
}
INSTANTIATE_TEST_SUITE_P(BuiltIn, EmbreeEngineOfScene, testing::ValuesIn(scene_names()),
                         [](const auto& info) { return info.param; });

/// Finds each hit, and whether a light is hidden, by our trees and by Embree, and counts the answers that differ.
struct BothSearches : peers::EmbreeSearch {
    std::int64_t all = 0;
    std::int64_t differing = 0;
};

template <Features features>
Hit<float> closest_hit(const SceneView<float>& scene, const Ray<float>& ray, std::int32_t leaving_id,
                       BothSearches& search) {
    ++search.all;
    NoTestCount nothing;
    const Hit<float> ours = raypool::closest_hit<features>(scene, ray, leaving_id, nothing);
    const Hit<float> theirs = peers::closest_hit<features>(scene, ray, leaving_id, search);
    if (ours.t != theirs.t || ours.primitive_id != theirs.primitive_id) ++search.differing;
    return ours;
}

template <Features features>
bool is_occluded(const SceneView<float>& scene, const Ray<float>& ray, std::int32_t leaving_id,
                 const Occlusion<float>& light, BothSearches& search) {
    ++search.all;
    NoTestCount nothing;
    const bool ours = raypool::is_occluded<features, float>(scene, ray, leaving_id, light, nothing);
    if (ours != peers::is_occluded<features>(scene, ray, leaving_id, light, search)) ++search.differing;
    return ours;
}

struct HitCount {
    std::int64_t differing = 0;
    std::int64_t all = 0;
};

HitCount count_hits(const Scene& described, std::int64_t spp) {
    const CompiledScene<float> scene = compile<float>(described);
    const peers::EmbreeScene embree(scene, peers::ShapeFunctions::make<kEverything, float>(),
                                    peers::EmbreeTriangles::Ours);
    BothSearches search;
    search.embree = &embree;
    ImageSettings settings;
    settings.light_sampling = LightSampling::Mis;
    recursive::Tracer<kEverything, float, BothSearches, Splitting::Off> tracer(
        scene, settings, fixed_point<float>(scene, settings, spp), search);
    for (std::int64_t y = 0; y < scene.height; ++y)
        for (std::int64_t x = 0; x < scene.width; ++x)
            for (std::int64_t s = 0; s < spp; ++s) tracer.sample<recursive::Form::Iterative>(x, y, s);
    EXPECT_EQ(tracer.work().all, tracer.segments() + tracer.shadow_rays()) << "the tracer finds hits in another way";
    return {tracer.work().differing, tracer.work().all};
}

/// Small spheres, still or in motion, or squares turned at random, strewn in a cube of edge 20, seen from `distance`.
Scene strewn(int spheres, int quads, double motion, double distance) {
    std::mt19937_64 random(3);
    const auto number = [&] { return static_cast<double>(random() >> 11U) * 0x1p-52 - 1; };  // in [-1, 1)
    const auto vector = [&] { return Vector3d(number(), number(), number()); };
    Scene scene;
    scene.width = scene.height = 150;
    scene.camera.look_from = distance * Vector3d(0.3, 0.2, 1);
    scene.camera.look_at = Vector3d::Zero();
    scene.camera.vertical_fov_degrees = std::max(0.001, 2 * std::atan(10 / distance) * 180 / std::numbers::pi);
    scene.camera.shutter_close = motion > 0 ? 1 : 0;
    scene.background = {Vector3d::Ones(), Vector3d::Ones()};
    scene.textures.emplace_back().even = Vector3d::Constant(0.8);
    scene.materials.emplace_back();
    for (int i = 0; i < spheres; ++i) {
        const Vector3d center = 10 * vector();
        scene.spheres.push_back({center, center + motion * vector(), 0.15, 0});
    }
    for (int i = 0; i < quads; ++i) {
        const Vector3d u = vector().normalized();
        const Vector3d v = u.cross(vector()).normalized();
        scene.quads.push_back({10 * vector(), 0.3 * u, 0.3 * v, 0});
    }
    return scene;
}

TEST(EmbreeHits, AreOursInEveryBuiltInScene) {
    for (const std::string& name : scene_names()) {
        const HitCount count = count_hits(small_scene(name, 100), 8);
        EXPECT_EQ(count.differing, 0) << name << ", of " << count.all;
    }
}

TEST(EmbreeHits, AreOursFromNearAndFar) {
    for (const double distance : {20.0, 2e3, 2e5}) {
        for (const Scene& scene : {strewn(5000, 0, 0, distance), strewn(5000, 0, 1.5, distance),
                                   strewn(0, 5000, 0, distance), strewn(2500, 2500, 1.5, distance)}) {
            const HitCount count = count_hits(scene, 8);
            EXPECT_EQ(count.differing, 0) << "from " << distance << ", of " << count.all;
        }
    }
}

TEST(EmbreeEngine, MakesTheImageOfStrewnShapes) {
    expect_same("strewn", compile<float>(strewn(2500, 2500, 0, 30)), settings_of(4));
    expect_same("strewn_in_motion", compile<float>(strewn(2500, 2500, 1.5, 30)), settings_of(4));
    expect_same("nothing", compile<float>(strewn(0, 0, 0, 30)), settings_of(1));
}

TEST(EmbreeEngine, MakesTheImageOfChosenPixelsAndInUnits) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 40));
    const std::vector<std::uint32_t> pixels{0, 3, 4, 41, 200, 399, 719};
    RenderSettings settings = settings_of(5);
    settings.pixels = &pixels;
    settings.threads = 2;
    expect_same("chosen_pixels", scene, settings);

    const Rendered expected = render(recursive::IterativeEngine(), scene, settings_of(5));
    for (const Engine* engine : kEngines) {
        const Rendered got = rendered_by(scene, settings_of(5), [&](Framebuffer& framebuffer) {
            const auto session = engine->begin(scene, settings_of(5), framebuffer);
            session->add({0, 2, nullptr});
            session->add({2, 5, nullptr});
            return session->finish();
        });
        EXPECT_TRUE(same_image("embree_units", expected, got, engine->name()));
    }
}

TEST(EmbreeEngine, MakesTheSumsOfSquares) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 40));
    const RenderSettings settings = settings_of(6);
    const auto hash = [&](const Engine& engine) {
        Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(6, scene.max_radiance), Halves::Apart);
        engine.render(scene, settings, framebuffer);
        return framebuffer.hash();
    };
    for (const Engine* engine : kEngines)
        EXPECT_EQ(hash(*engine), hash(recursive::IterativeEngine())) << engine->name();
}

TEST(EmbreeEngine, RefusesWhatItHasNot) {
    const Scene described = small_scene("paper", 8);
    const CompiledScene<float> scene = compile<float>(described);
    const CompiledScene<double> in_double = compile<double>(described);
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(1, scene.max_radiance));
    CostImage cost(Cost::Segments, scene.width, scene.height);
    RenderSettings splitting;
    splitting.split_depth = 1;
    RenderSettings counting;
    counting.count_work = true;
    RenderSettings with_cost;
    with_cost.cost_image = &cost;
    std::vector<const Engine*> engines = kEngines;
    const EmbreeEngine of_triangles(EmbreeRays::Single, peers::EmbreeTriangles::Embrees);
    engines.push_back(&of_triangles);
    for (const Engine* engine : engines) {
        EXPECT_THROW((void)engine->begin(scene, splitting, framebuffer), InputError);
        EXPECT_THROW((void)engine->begin(scene, counting, framebuffer), InputError);
        EXPECT_THROW((void)engine->begin(scene, with_cost, framebuffer), InputError);
        EXPECT_THROW((void)engine->begin(in_double, {}, framebuffer), InputError);
    }
}

}  // namespace
}  // namespace raypool
