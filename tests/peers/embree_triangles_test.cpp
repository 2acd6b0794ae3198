// Embree's own triangles: the same hits as ours but where rays pass along edges, and images of the same mean.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <string>
#include <vector>

#include "bench/peers/embree_engine.h"
#include "bench/peers/embree_scene.h"
#include "bench/peers/mean_difference.h"
#include "core/runtime/settings_text.h"
#include "tests/equivalence/same_image.h"
#include "tests/meshes.h"
#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

using peers::EmbreeRays;
using peers::EmbreeTriangles;
using test::RandomInputs;

const peers::EmbreeEngine kOwnSingle(EmbreeRays::Single, EmbreeTriangles::Embrees);
const peers::EmbreeEngine kOwnPacket(EmbreeRays::Packet, EmbreeTriangles::Embrees);
const std::vector<const peers::EmbreeEngine*> kOwnTriangles{&kOwnSingle, &kOwnPacket};

/// A bumpy ball, triangles strewn around it and a ball of glass in a room of quads under a lamp.
TestScene meshes_in_room() {
    TestScene scene(48, 48, Vector3d::Zero());
    scene.look({0, 2, 7.5}, {0, 0, 0}, 70);
    const std::int32_t wall = scene.diffuse(0.7);
    const std::int32_t lamp = scene.emitter(6);
    const std::int32_t glass = scene.glass(1.5);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-8.0, 8.0}) {
            Vector3d corner = Vector3d::Constant(-8);
            corner[axis] = side;
            scene.quad(corner, 16 * Vector3d::Unit((axis + 1) % 3), 16 * Vector3d::Unit((axis + 2) % 3), wall);
        }
    }
    scene.quad({-3, 7.5, -3}, {6, 0, 0}, {0, 0, 6}, lamp);
    scene.sphere({2, -1, 3}, 0.8, glass);
    Mesh ball = test::icosphere(5);
    for (auto& [x, y, z] : ball.positions) {
        const float bump = 2 + 0.2F * std::sin(9 * x) * std::sin(8 * y) * std::sin(7 * z);
        x *= bump, y *= bump, z *= bump;
    }
    Mesh strewn;
    RandomInputs random(8);
    for (std::uint32_t first = 0; first < 6000; first += 3) {
        const Vector3d corner = random.point<double>(6);
        for (int i = 0; i < 3; ++i) {
            const Vector3d at = i == 0 ? corner : Vector3d(corner + random.point<double>(0.5));
            strewn.positions.push_back(
                {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])});
        }
        strewn.triangles.push_back({first, first + 1, first + 2});
    }
    for (Mesh* mesh : {&ball, &strewn}) {
        MeshShape shape{std::make_shared<const Mesh>(std::move(*mesh))};
        shape.material_id = wall;
        scene.meshes.push_back(std::move(shape));
    }
    return scene;
}

struct HitDifferences {
    std::int64_t hits = 0;       ///< rays that meet something by our search
    std::int64_t other = 0;      ///< that meet another primitive by Embree's, or none, ...
    std::int64_t far_apart = 0;  ///< and of these, at distances that do not agree to 1/10,000
    double most_off = 0;         ///< relative difference of the distances to one primitive

    void add(const Hit<float>& ours, float t, std::int32_t id) {
        constexpr float kTie = 1e-4F;
        if (ours.primitive_id == kNoPrimitive && id == kNoPrimitive) return;
        ++hits;
        const float off = std::abs(t - ours.t) / ours.t;
        if (ours.primitive_id == id) {
            most_off = std::max(most_off, static_cast<double>(off));
        } else {
            ++other;
            if (!(off <= kTie)) ++far_apart;
        }
    }
};

/// Rays between points of a cube that holds the mesh, by single rays and by packets.
void compare_hits(const Scene& described, double cube, HitDifferences& single, HitDifferences& packets) {
    using peers::Packet;
    const CompiledScene<float> scene = compile<float>(described);
    const peers::EmbreeScene of_single(scene, peers::ShapeFunctions::make<kEverything, float>(),
                                       EmbreeTriangles::Embrees);
    const peers::EmbreeScene of_packets(scene, peers::ShapeFunctions::make<kEverything, Packet>(),
                                        EmbreeTriangles::Embrees);
    peers::EmbreeSearch search;
    search.embree = &of_single;
    NoTestCount nothing;
    RandomInputs random(3);
    constexpr int kRays = kLanes<Packet>;
    for (int i = 0; i < test::kInputs; i += kRays) {
        Ray<Packet> rays{};
        Hit<float> ours[kRays];
        for (int k = 0; k < kRays; ++k) {
            const Vector3d from = random.point<double>(cube);
            const Vector3d to = random.point<double>(cube);
            Ray<float> ray{from.cast<float>(), (to - from).normalized().cast<float>(), 0};
            ours[k] = closest_hit<kEverything>(scene, ray, kNoPrimitive, nothing);
            const Hit<float> theirs = peers::closest_hit<kEverything>(scene, ray, kNoPrimitive, search);
            single.add(ours[k], theirs.t, static_cast<std::int32_t>(theirs.primitive_id));
            for (int axis = 0; axis < 3; ++axis) {
                rays.origin[axis][k] = ray.origin[axis];
                rays.direction[axis][k] = ray.direction[axis];
            }
        }
        const Hit<Packet> hits =
            peers::closest_hits<kEverything>(of_packets, scene, rays, Int<Packet>(kNoPrimitive), Mask<Packet>(true));
        for (int k = 0; k < kRays; ++k)
            packets.add(ours[k], lane(hits.t, k), static_cast<std::int32_t>(lane(hits.primitive_id, k)));
    }
}

// When this was written: 4 of 397,786 hits on the ball, 2 of a million in the room, and 1 of each far apart.
TEST(EmbreeTriangles, AreMetByAMillionRaysAsOursAre) {
    struct {
        const char* name;
        Scene scene;
        double cube;
    } const cases[] = {{"ball", test::scene_of(test::icosphere(6)), 2}, {"room", meshes_in_room(), 7}};
    for (const auto& [name, scene, cube] : cases) {
        HitDifferences single;
        HitDifferences packets;
        compare_hits(scene, cube, single, packets);
        for (const auto& [of, found] : {std::pair{"single", single}, std::pair{"packets", packets}}) {
            SCOPED_TRACE(fmt::format("{}, {}: of {} hits {} on another primitive, {} of them far apart; {:.1e} off",
                                     name, of, found.hits, found.other, found.far_apart, found.most_off));
            EXPECT_GT(found.hits, test::kInputs / 10);
            EXPECT_LE(found.other, 20);
            EXPECT_LE(found.far_apart, 5);
            EXPECT_LE(found.most_off, 1e-3);
        }
    }
}

// Not so at vertices: Embree lets some 6000 of a million rays through there, and 180,000 in a scene that is not robust.
TEST(EmbreeTriangles, LetNoRayThroughAtEdges) {
    const Vector3d center(0.3, 0.2, 0.1);
    const Mesh ball = test::icosphere(6);
    const CompiledScene<float> scene = compile<float>(test::scene_of(ball, center));
    const peers::EmbreeScene embree(scene, peers::ShapeFunctions::make<kEverything, float>(), EmbreeTriangles::Embrees);
    peers::EmbreeSearch search;
    search.embree = &embree;
    RandomInputs random(5);
    int leaks = 0;
    for (const auto& triangle : ball.triangles) {
        const Vec3<float> from = (center + random.point<double>(0.2)).cast<float>();
        for (std::size_t i = 0; i < 3; ++i) {
            const auto corner = [&](std::size_t k) {
                const float* at = scene.vertices[triangle[k % 3]].value;
                return vec3<float>(at[0], at[1], at[2]);
            };
            const auto part = static_cast<float>(random.uniform(0.01, 0.99));
            const Vec3<float> to = corner(i) + part * (corner(i + 1) - corner(i));
            const Ray<float> ray{from, (to - from).normalized(), 0};
            if (peers::closest_hit<kEverything>(scene, ray, kNoPrimitive, search).primitive_id == kNoPrimitive) ++leaks;
        }
    }
    EXPECT_EQ(leaks, 0) << "of " << 3 * ball.triangles.size();
}

/// By every way to sample lights.
void expect_same_mean(const CompiledScene<float>& scene) {
    RenderSettings settings;
    settings.end_sample = 8;
    settings.threads = 2;
    for (const LightSampling sampling : {LightSampling::None, LightSampling::Light, LightSampling::Mis}) {
        settings.light_sampling = sampling;
        const Rendered expected = render(recursive::IterativeEngine(), scene, settings);
        for (const peers::EmbreeEngine* engine : kOwnTriangles) {
            const Rendered got = render(*engine, scene, settings);
            const auto off = peers::mean_difference(got.framebuffer, expected.framebuffer);
            SCOPED_TRACE(fmt::format("{}, {}: {} standard errors, {}", engine->name(), to_string(sampling),
                                     off.standard_errors, off.relative));
            EXPECT_TRUE(engine->is_independent(scene));
            EXPECT_TRUE(off.is_noise());
            EXPECT_LT(std::abs(off.relative), 1e-3);
            EXPECT_EQ(got.report.paths(), expected.report.paths());
        }
    }
}

TEST(EmbreeTriangles, MakeAnImageOfTheSameMean) {
    expect_same_mean(compile<float>(meshes_in_room()));
}

TEST(EmbreeTriangles, DoNotHideThemselvesWhereTheyAreLights) {
    TestScene scene = meshes_in_room();
    Mesh lamp = test::icosphere(2);
    for (auto& position : lamp.positions) position[1] += 4.5F;
    MeshShape shape{std::make_shared<const Mesh>(std::move(lamp))};
    shape.material_id = scene.emitter(6);
    scene.meshes.push_back(std::move(shape));
    expect_same_mean(compile<float>(scene));
}

TEST(EmbreeTriangles, MakeTheImageOfEveryEngineInASceneWithoutMeshes) {
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 40));
    RenderSettings settings;
    settings.end_sample = 4;
    settings.light_sampling = LightSampling::Mis;
    const Rendered expected = render(recursive::IterativeEngine(), scene, settings);
    for (const peers::EmbreeEngine* engine : kOwnTriangles) {
        EXPECT_FALSE(engine->is_independent(scene));
        EXPECT_TRUE(same_image("embree_no_mesh", expected, render(*engine, scene, settings), engine->name()));
    }
    EXPECT_EQ(peers::embree_engines(false).size(), 2U);
    EXPECT_EQ(peers::embree_engines(true).size(), 4U);
}

TEST(EmbreeTriangles, WithoutAnAreaAreNotMet) {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{3, 3, 3}, {0, 3, 0}, {0, 1, 2}};
    const CompiledScene<float> scene = compile<float>(test::scene_of(mesh));
    const peers::EmbreeScene embree(scene, peers::ShapeFunctions::make<kEverything, float>(), EmbreeTriangles::Embrees);
    peers::EmbreeSearch search;
    search.embree = &embree;
    const Ray<float> ray{{0, 0, 5}, {0, 0, -1}, 0};
    const Hit<float> hit = peers::closest_hit<kEverything>(scene, ray, kNoPrimitive, search);
    EXPECT_EQ(hit.primitive_id, scene.first_triangle + 2);
    EXPECT_EQ(hit.t, 5);
}

TEST(MeanDifference, TellsABiasFromNoise) {
    const FixedPoint fixed = FixedPoint::make(1, 1);
    constexpr std::int64_t kEdge = 100;
    Framebuffer expected(kEdge, kEdge, fixed);
    Framebuffer noisy(kEdge, kEdge, fixed);
    Framebuffer biased(kEdge, kEdge, fixed);
    RandomInputs random(2);
    for (std::int64_t pixel = 0; pixel < kEdge * kEdge; ++pixel) {
        const auto noise = [&] { return static_cast<std::int64_t>(random.uniform(-1e6, 1e6)); };
        const std::int64_t value = 1'000'000'000;
        expected.add(pixel, {value, value, value});
        noisy.add(pixel, {value + noise(), value, value});
        biased.add(pixel, {value + noise() + 50'000, value, value});
    }
    EXPECT_EQ(peers::mean_difference(expected, expected).standard_errors, 0);
    EXPECT_EQ(peers::mean_difference(expected, expected).differing_pixels, 0);
    EXPECT_TRUE(peers::mean_difference(noisy, expected).is_noise());
    EXPECT_GT(peers::mean_difference(noisy, expected).differing_pixels, 0.99);
    const peers::MeanDifference off = peers::mean_difference(biased, expected);
    EXPECT_FALSE(off.is_noise());
    EXPECT_NEAR(off.relative, 50'000 / 3e9, 5e-6);
    // A bias the other way is one too, and one pixel that is far off is not.
    EXPECT_FALSE(peers::mean_difference(expected, biased).is_noise());
    Framebuffer one = expected;
    one.add(0, {1'000'000'000, 0, 0});
    EXPECT_TRUE(peers::mean_difference(one, expected).is_noise());
}

}  // namespace
}  // namespace raypool
