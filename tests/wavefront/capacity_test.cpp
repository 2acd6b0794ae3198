/// How many records a pool has room for where nobody says: by the trees and the cache, and never more than it was
/// given.
#include "wavefront/capacity.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"
#include "tests/small_render.h"
#include "wavefront/engine.h"

namespace raypool::wavefront {
namespace {

constexpr std::size_t kCache = std::size_t{1} << 20U;

TEST(ThreadCapacity, FitsTheCacheWhereTheTreesDo) {
    for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, kCache / 2, kCache, 2 * kCache - 1})
        EXPECT_EQ(thread_capacity(bytes, kCache, 1), 8192) << bytes;
}

TEST(ThreadCapacity, GrowsWithTheTreesUpTo64Fold) {
    EXPECT_EQ(thread_capacity(2 * kCache, kCache, 1), 16384);
    EXPECT_EQ(thread_capacity(5'600'000, kCache, 1), 32768);  // 100,000 spheres
    EXPECT_EQ(thread_capacity(16 * kCache, kCache, 1), 131072);
    EXPECT_EQ(thread_capacity(56'000'000, kCache, 1), 262144);  // a million
    EXPECT_EQ(thread_capacity(std::numeric_limits<std::size_t>::max(), kCache, 1), 524288);
    EXPECT_EQ(thread_capacity(std::numeric_limits<std::size_t>::max(), 1, 1), 524288);
}

TEST(ThreadCapacity, OfManyThreadsIsBoundedTogether) {
    EXPECT_EQ(thread_capacity(100 * kCache, kCache, 32), 524288);
    EXPECT_EQ(thread_capacity(100 * kCache, kCache, 33), 262144);
    EXPECT_EQ(thread_capacity(100 * kCache, kCache, 1024), 16384);
    EXPECT_EQ(thread_capacity(100 * kCache, kCache, 4096), 8192);
    EXPECT_EQ(thread_capacity(0, kCache, 4096), 8192);
}

/// Of trees of some ten times the smallest cache that there is.
Scene many_spheres() {
    test::RandomInputs random(1);
    Scene scene = builtin_scene("one_sphere");
    scene.width = 24;
    scene.height = 16;
    const Sphere first = scene.spheres.front();
    for (int i = 0; i < 60'000; ++i) {
        Sphere sphere = first;
        sphere.radius = 0.01 * first.radius;
        sphere.center0 = sphere.center1 = first.center0 + 3 * first.radius * random.point<double>(1);
        scene.spheres.push_back(sphere);
    }
    return scene;
}

TEST(PoolCapacity, IsWhatTheSettingsSayOrElseFollowsTheScene) {
    const CompiledScene<float> scene = compile<float>(many_spheres());
    EXPECT_EQ(pool_capacity({.capacity = 100}, scene, 1), 100);
    EXPECT_EQ(pool_capacity({.scope = PoolScope::Shared}, scene, 1), PoolSettings::kSharedCapacity);
    EXPECT_EQ(pool_capacity({}, scene, 3), thread_capacity(tree_bytes(scene), second_level_cache(), 3));
    EXPECT_GT(tree_bytes(scene), std::size_t{60'000} / 8 * sizeof(scene.sphere_tree.blocks[0]));
    EXPECT_LT(tree_bytes(scene), scene.bytes());
}

TEST(PoolCapacity, OfASessionIsReportedAndChangesNoBit) {
    const CompiledScene<float> scene = compile<float>(many_spheres());
    RenderSettings settings;
    settings.end_sample = 2;
    std::string expected;
    for (const std::int64_t capacity : {std::int64_t{50}, PoolSettings::kThreadCapacity, PoolSettings::kAutomatic}) {
        const PoolSettings pool{.capacity = capacity};
        Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(2, scene.max_radiance));
        const RenderReport report = WavefrontEngine(pool).render(scene, settings, framebuffer);
        EXPECT_EQ(pool_report(report).pool_rays,
                  static_cast<std::size_t>(pool_capacity(pool, scene, settings.threads)));
        if (expected.empty()) expected = framebuffer.hash();
        EXPECT_EQ(framebuffer.hash(), expected);
    }
}

}  // namespace
}  // namespace raypool::wavefront
