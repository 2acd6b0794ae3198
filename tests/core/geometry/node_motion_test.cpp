/// Boxes that move with their spheres: at any time they hold each sphere's own box to the last bit, and they spare
/// work.
#include "core/geometry/node_motion.h"

#include <gtest/gtest.h>

#include "core/geometry/traverse.h"
#include "core/shading/compiled_scene.h"
#include "tests/core/geometry/brute_force.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

constexpr Features kMoving{.motion = true};

/// Equal spheres around a place. Each moves by `common` and by up to `own` more, in radii.
Scene moving_cloud(int count, double translation, const Vector3d& common, double own) {
    RandomInputs random(1);
    Scene scene;
    scene.textures.emplace_back().even = {0.5, 0.5, 0.5};
    scene.materials.emplace_back();
    scene.camera.shutter_close = 1;
    const double radius = 0.3;
    const Vector3d place = translation * random.direction<double>();
    for (int i = 0; i < count; ++i) {
        const Vector3d center = place + random.point<double>(20 * radius);
        const Vector3d motion = radius * common + random.point<double>(own * radius);
        scene.spheres.push_back({center, center + motion, radius, 0});
    }
    return scene;
}

template <class Scalar>
struct Side {
    Scalar low, high;
};
/// As single rays see it, which read the bounds of all children at once.
template <class Scalar>
Side<Scalar> child_bounds(const auto& tree, std::size_t node, int lane, int axis, Scalar time) {
    using Boxes = Wide<Scalar, kTreeWidth<Scalar>>;
    const raypool::detail::TreeBounds<kMoving, std::remove_cvref_t<decltype(tree)>> bounds(tree);
    Boxes low;
    Boxes high;
    bounds.template children<Boxes>(node, axis, 0, Boxes(time), low, high);
    return {raypool::lane(low, lane), raypool::lane(high, lane)};
}

/// What the own boxes of the spheres below a child reach along an axis, as kernels compute them.
template <class Scalar>
Side<Scalar> spheres_below(const auto& tree, std::int32_t child, int axis, Scalar time) {
    Side<Scalar> reach{kInfinity<Scalar>, -kInfinity<Scalar>};
    const auto extend = [&](Scalar low, Scalar high) {
        reach.low = std::min(reach.low, low);
        reach.high = std::max(reach.high, high);
    };
    if (child < 0) {
        const auto& block = tree.blocks[static_cast<std::size_t>(~child)];
        for (int lane = 0; lane < block.kLanes && block.id[lane] != kNoPrimitive; ++lane) {
            const Vec3<Scalar> center =
                center_at<Scalar>(lane_of<Scalar>(block.center, lane), lane_of<Scalar>(block.motion, lane), time);
            extend(center[axis] - block.padded_radius[lane], center[axis] + block.padded_radius[lane]);
        }
        return reach;
    }
    for (const std::int32_t below : tree.nodes[static_cast<std::size_t>(child)].child) {
        if (below == 0) continue;  // unused
        const Side<Scalar> side = spheres_below<Scalar>(tree, below, axis, time);
        extend(side.low, side.high);
    }
    return reach;
}

template <class Scalar>
class NodeMotion : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(NodeMotion, Scalars);

TYPED_TEST(NodeMotion, HoldsTheBoxesOfSpheresAtEveryTime) {
    RandomInputs random(2);
    std::vector<TypeParam> times{0, 1 - 0x1p-24F, 1};
    for (int i = 0; i < 30; ++i) times.push_back(random.unit_interval<TypeParam>());
    for (const double translation : {0.0, 1e3, 1e6}) {
        for (const double own : {1e-3, 0.5, 30.0}) {
            const auto scene = compile<TypeParam>(moving_cloud(500, translation, {0, 3, -100}, own));
            const auto& tree = scene.sphere_tree;
            ASSERT_GT(tree.nodes.size(), 5U);
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_EQ(tree.motion[axis].size(), tree.nodes.size());
                for (std::size_t node = 0; node < tree.nodes.size(); ++node) {
                    for (int lane = 0; lane < kTreeWidth<TypeParam>; ++lane) {
                        const std::int32_t child = tree.nodes[node].child[lane];
                        for (const TypeParam time : times) {
                            const auto box = child_bounds<TypeParam>(tree, node, lane, axis, time);
                            if (child == 0) {
                                ASSERT_GT(box.low, box.high) << "an unused lane is entered";
                                continue;
                            }
                            const auto spheres = spheres_below<TypeParam>(tree, child, axis, time);
                            ASSERT_LE(box.low, spheres.low) << "at " << time << " of " << translation << ", " << own;
                            ASSERT_GE(box.high, spheres.high) << "at " << time << " of " << translation << ", " << own;
                        }
                    }
                }
            }
        }
    }
}

TYPED_TEST(NodeMotion, IsThereAlongNoAxisOnWhichNothingMoves) {
    Scene scene = moving_cloud(100, 0, {0, 0, 0}, 0);
    for (const auto& along_axis : compile<TypeParam>(scene).sphere_tree.motion) EXPECT_TRUE(along_axis.empty());
    scene.spheres[7].center1.y() += 0.1;
    const auto compiled = compile<TypeParam>(scene);
    EXPECT_TRUE(compiled.sphere_tree.motion[0].empty());
    EXPECT_FALSE(compiled.sphere_tree.motion[1].empty());
    EXPECT_TRUE(compiled.sphere_tree.motion[2].empty());
}

/// Spheres that all move alike are a cloud that is somewhere else at each time, and over the shutter a long one.
TYPED_TEST(NodeMotion, SparesTestsAndLosesNoHit) {
    const auto scene = compile<TypeParam>(moving_cloud(500, 0, {0, 0, 40}, 0.5));
    auto over_the_shutter = scene;
    for (auto& along_axis : over_the_shutter.sphere_tree.motion) along_axis = {};
    RandomInputs random(3);
    TestCount spared;
    TestCount all;
    int hits = 0;
    constexpr int kRays = 2000;
    for (int i = 0; i < kRays; ++i) {
        Ray<TypeParam> ray;
        ray.origin = random.point<TypeParam>(8);
        ray.direction = random.direction<TypeParam>();
        ray.time = random.unit_interval<TypeParam>();
        const Hit<TypeParam> expected = brute_force_hit<TypeParam>(scene, ray, kNoPrimitive);
        const Hit<TypeParam> hit = closest_hit<kMoving>(scene, ray, kNoPrimitive, spared);
        ASSERT_EQ(hit.t, expected.t);
        ASSERT_EQ(hit.primitive_id, expected.primitive_id);
        ASSERT_EQ(closest_hit<kMoving>(over_the_shutter, ray, kNoPrimitive, all).t, expected.t);
        hits += hit.primitive_id >= 0 ? 1 : 0;
    }
    EXPECT_GT(hits, kRays / 20);
    EXPECT_LT(3 * spared.primitive_tests, 2 * all.primitive_tests);
    EXPECT_LT(spared.box_tests, all.box_tests);
}

}  // namespace
}  // namespace raypool::test
