/// The tables that kernels read: what is refused, boxes that hold what they should, and shapes that are all there.
#include "core/shading/compiled_scene.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/geometry/shapes.h"
#include "core/geometry/traverse.h"
#include "core/scene/scene_reader.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

Scene empty_scene() {
    Scene scene;
    scene.textures.emplace_back().even = {0.5, 0.5, 0.5};
    scene.materials.emplace_back();
    return scene;
}
/// Equal spheres in a cloud, none of which spans the scene.
Scene cloud(int count, double radius, double translation, double motion) {
    RandomInputs random(1);
    Scene scene = empty_scene();
    scene.camera.shutter_close = 1;
    const Vector3d place = translation * random.direction<double>();
    for (int i = 0; i < count; ++i) {
        const Vector3d center = place + random.point<double>(20 * radius);
        scene.spheres.push_back({center, center + random.point<double>(motion * radius), radius, 0});
    }
    return scene;
}

std::string refusal(const Scene& scene) {
    try {
        compile<float>(scene);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Compile, RefusesImagesOfMorePixelsThanARayRecordCanName) {
    Scene scene = empty_scene();
    scene.width = scene.height = 65536;
    EXPECT_EQ(refusal(scene), "");
    EXPECT_EQ(compile<float>(scene).pixel_count(), std::int64_t{1} << 32U);
    scene.width = 65537;
    EXPECT_EQ(refusal(scene), "image of 65537 x 65536: must have at most 2^32 pixels");
}

template <class Blocks>
void count_ids(const Blocks& blocks, std::vector<int>& uses) {
    for (const auto& block : blocks)
        for (const std::int32_t id : block.id)
            if (id != kNoPrimitive) ++uses.at(static_cast<std::size_t>(id));
}

TEST(Compile, KeepsEveryShapeInOneBlock) {
    for (const std::string& name : builtin_scene_names()) {
        const Scene scene = builtin_scene(name);
        const CompiledScene<float> compiled = compile<float>(scene);
        const std::size_t shape_count = scene.spheres.size() + scene.quads.size() + scene.planes.size();
        EXPECT_EQ(compiled.surfaces.size(), shape_count);
        std::vector<int> uses(shape_count);
        count_ids(compiled.large_spheres, uses);
        count_ids(compiled.planes, uses);
        count_ids(compiled.sphere_tree.blocks, uses);
        count_ids(compiled.quad_tree.blocks, uses);
        EXPECT_EQ(uses, std::vector<int>(shape_count, 1)) << name;
    }
}

/// The bounds of a child of a node hold the own boxes of all spheres below it, at every time.
template <class Tree>
Box check_bounds(const Tree& tree, std::int32_t child, const std::vector<float>& times) {
    Box below;
    if (child >= 0) {
        const auto& node = tree.nodes[static_cast<std::size_t>(child)];
        for (int lane = 0; lane < std::ssize(node.child); ++lane) {
            Box bounds;
            for (int axis = 0; axis < 3; ++axis) {
                bounds.low[axis] = node.bounds[axis][0][lane];
                bounds.high[axis] = node.bounds[axis][1][lane];
            }
            if (bounds.low[0] > bounds.high[0]) continue;  // unused
            const Box inside = check_bounds(tree, node.child[lane], times);
            EXPECT_TRUE((bounds.low.array() <= inside.low.array()).all());
            EXPECT_TRUE((bounds.high.array() >= inside.high.array()).all());
            below.extend(bounds);
        }
        return below;
    }
    const auto& block = tree.blocks[static_cast<std::size_t>(~child)];
    for (int lane = 0; lane < block.kLanes; ++lane) {
        if (block.id[lane] == kNoPrimitive) continue;
        for (const float time : times) {
            for (int axis = 0; axis < 3; ++axis) {
                const float center = block.center[axis][lane] + time * block.motion[axis][lane];
                below.low[axis] = std::min(below.low[axis], double{center - block.padded_radius[lane]});
                below.high[axis] = std::max(below.high[axis], double{center + block.padded_radius[lane]});
            }
        }
    }
    return below;
}

TEST(Compile, BoundsMovingSpheresAtEveryTime) {
    RandomInputs random(2);
    std::vector<float> times{0, 1 - 0x1p-24F, 1};
    for (int i = 0; i < 50; ++i) times.push_back(random.unit_interval<float>());
    for (const double translation : {0.0, 1e4, 1e6}) {
        const CompiledScene<float> scene = compile<float>(cloud(1000, 1, translation, 3));
        ASSERT_GT(scene.sphere_tree.nodes.size(), 10U);
        check_bounds(scene.sphere_tree, 0, times);
    }
}

/// Rays that graze a sphere where it touches its box, at the ends of its axes.
TEST(Compile, PadsTheBoxOfASphereSoThatItTakesNoHitAway) {
    int lost = 0;
    int lost_unpadded = 0;
    int hits = 0;
    for (const auto& [radius, translation] : {std::pair{1.0, 0.0}, {1.0, 1e3}, {0.01, 10.0}, {1e3, 0.0}, {1e3, 1e5}}) {
        const CompiledScene<float> scene = compile<float>(cloud(64, radius, translation, 0));
        ASSERT_FALSE(scene.sphere_tree.blocks.empty());
        RandomInputs random(3);
        for (int i = 0; i < kInputs / 5; ++i) {
            const auto& block = scene.sphere_tree.blocks[static_cast<std::size_t>(i) % scene.sphere_tree.blocks.size()];
            const int lane = i % block.kLanes;
            if (block.id[lane] == kNoPrimitive) continue;
            const float r = block.radius[lane];
            const Vec3<float> center = vec3<float>(block.center[0][lane], block.center[1][lane], block.center[2][lane]);
            Vec3<double> normal = 1e-3 * random.direction<double>();
            const int axis = random.below(3);
            normal[axis] += random.one_in(2) ? 1 : -1;
            normal.normalize();
            const Vec3<double> aside = random.direction<double>();
            const Vec3<double> way = (aside - aside.dot(normal) * normal).normalized();
            const double height = r * (1 - random.uniform(0, 3e-7));
            const Vec3<double> start = center.cast<double>() + height * normal - random.uniform(1, 5) * r * way;
            const Vec3<float> origin = start.cast<float>();
            const Vec3<float> direction = way.cast<float>();
            const float t = sphere_distance<float>(origin, direction, center, r, false);
            if (t == kInfinity<float>) continue;
            ++hits;
            const RayInverse<float> inverse = ray_inverse<float>(direction);
            const auto is_in_box = [&](float half_edge) {
                return is_inside_box<float>((center.array() - half_edge).matrix(),
                                            (center.array() + half_edge).matrix(), origin, inverse, t);
            };
            if (!is_in_box(block.padded_radius[lane])) ++lost;
            if (!is_in_box(r)) ++lost_unpadded;
        }
    }
    EXPECT_GT(hits, kInputs / 10);
    EXPECT_EQ(lost, 0);
    EXPECT_GT(lost_unpadded, 0) << "these rays would not need the padding";
}

TEST(Compile, SetsAsideSpheresThatSpanTheSceneWithoutChangingAHit) {
    Scene alone = cloud(300, 0.3, 0, 1);
    alone.spheres.push_back({{0, -1000, 0}, {0, -1000, 0}, 997, 0});
    const std::int32_t ground_id = 300;
    Scene among_larger = alone;  // the ground is no longer large beside these
    for (const double x : {-1e5, -5e4, 5e4, 1e5}) {
        const Vector3d far(x, 3e5, 0);
        among_larger.spheres.push_back({far, far, 1500, 0});
    }
    const CompiledScene<float> a = compile<float>(alone);
    const CompiledScene<float> b = compile<float>(among_larger);
    ASSERT_EQ(a.large_spheres.size(), 1U);
    EXPECT_EQ(a.large_spheres[0].id[0], ground_id);
    ASSERT_TRUE(b.large_spheres.empty());

    RandomInputs random(4);
    int ground_hits = 0;
    for (int i = 0; i < kInputs / 10; ++i) {
        const Ray<float> ray{random.point<float>(4), random.direction<float>(), random.unit_interval<float>()};
        NoTestCount work;
        const Hit<float> in_a = closest_hit<kEverything>(a, ray, kNoPrimitive, work);
        const Hit<float> in_b = closest_hit<kEverything>(b, ray, kNoPrimitive, work);
        if (in_b.primitive_id > ground_id) continue;
        ASSERT_EQ(in_a.primitive_id, in_b.primitive_id);
        ASSERT_EQ(in_a.t, in_b.t);
        ground_hits += in_a.primitive_id == ground_id ? 1 : 0;
    }
    EXPECT_GT(ground_hits, kInputs / 100);
}

TEST(Compile, FindsTheGreatestRadianceThatAPathCanCarry) {
    Scene scene = empty_scene();
    EXPECT_EQ(compile<float>(scene).max_radiance, 0);
    scene.background.bottom = {0.5, 3, 1};
    EXPECT_EQ(compile<float>(scene).max_radiance, 3);
    Texture lamp;
    lamp.kind = Texture::Kind::Checker3d;
    lamp.even = {1, 2, 3};
    lamp.odd = {40, 5, 6};
    scene.textures.push_back(lamp);
    Material glow;
    glow.kind = Material::Kind::Emissive;
    glow.texture_id = 1;
    scene.materials.push_back(glow);
    EXPECT_EQ(compile<float>(scene).max_radiance, 3) << "nothing shines yet";
    scene.spheres.emplace_back().material_id = 1;
    EXPECT_EQ(compile<float>(scene).max_radiance, 40);
}

TEST(Compile, KeepsCheckerScalesInTwoParts) {
    for (const double edge : {0.32, 0.1, 1.0 / 3, 7.7}) {
        Scene scene = empty_scene();
        scene.textures[0].kind = Texture::Kind::Checker3d;
        scene.textures[0].scale = edge;
        const CompiledScene<float> compiled = compile<float>(scene);
        const auto* row = compiled.textures[0].value;
        const double high = row[TextureRow<float>::kScaleHigh];
        const double low = row[TextureRow<float>::kScaleLow];
        EXPECT_NEAR(high * edge, 1, 1e-7);
        EXPECT_NEAR((high + low) * edge, 1, 1e-14);
    }
}

TEST(Compile, GivesQuadsCoordinatesFromZeroToOneAlongTheirEdges) {
    RandomInputs random(5);
    Scene scene = empty_scene();
    for (int i = 0; i < 100; ++i) {
        const Vector3d corner = random.point<double>(5);
        const Vector3d u = random.point<double>(3);
        scene.quads.push_back({corner, u, random.point<double>(3), 0});
    }
    const CompiledScene<double> compiled = compile<double>(scene);
    for (std::size_t i = 0; i < scene.quads.size(); ++i) {
        const Quad& quad = scene.quads[i];
        const auto* row = compiled.planars[i].value;
        const auto part = [&](int first) { return vec3<double>(row[first], row[first + 1], row[first + 2]); };
        const double s = random.uniform(0, 1);
        const double t = random.uniform(0, 1);
        const auto [u, v] =
            plane_coordinates<double>(quad.corner + s * quad.edge_u + t * quad.edge_v, part(PlanarRow<double>::kCorner),
                                      part(PlanarRow<double>::kDualU), part(PlanarRow<double>::kDualV));
        EXPECT_NEAR(u, s, 1e-12);
        EXPECT_NEAR(v, t, 1e-12);
        const auto* surface = compiled.surfaces[i].value;
        const Vec3<double> normal = vec3<double>(surface[0], surface[1], surface[2]);
        EXPECT_NEAR(normal.norm(), 1, 1e-15);
        EXPECT_NEAR(normal.dot(quad.edge_u), 0, 1e-12);
        EXPECT_NEAR(normal.dot(quad.edge_v), 0, 1e-12);
    }
}

}  // namespace
}  // namespace raypool::test
