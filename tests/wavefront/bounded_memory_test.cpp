/// A pool stays within its capacity, whatever the depth and the number of branches, and makes the image of recursion.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/wavefront/pool_renders.h"

namespace raypool::wavefront {
namespace {

/// A camera inside a mirror: no path ever ends. The lens is open and the mirror is rough, so that all paths differ.
Scene cavity() {
    Scene scene;
    scene.width = 4;
    scene.height = 2;
    scene.camera.look_from = {0.1, 0.2, 0.3};
    scene.textures.emplace_back().even = {1, 1, 1};
    Material& mirror = scene.materials.emplace_back();
    mirror.kind = Material::Kind::Metal;
    scene.spheres.emplace_back().radius = 3;
    return scene;
}

TEST(DeepPaths, EndInASmallPoolOfEitherScopeInTheMemoryOfShallowOnes) {
    constexpr std::int32_t kDepth = 100'000;
    const CompiledScene<float> scene = compile<float>(cavity());
    PoolSettings thread_pool;
    thread_pool.capacity = 64;
    for (const PoolSettings& pool : {thread_pool, shared_pool(64)}) {
        const Rendered shallow = render_pool(scene, settings_of(1, 3), pool);
        const Rendered deep = render_pool(scene, settings_of(1, kDepth), pool);
        EXPECT_EQ(deep.report.segments(), std::int64_t{kDepth} * scene.pixel_count());
        EXPECT_EQ(deep.report.memory_bytes, shallow.report.memory_bytes);
        EXPECT_LT(deep.report.memory_bytes, 1U << 20U);
        EXPECT_LE(pool_report(deep.report).rounds.size(), 4096U)
            << "one figure for each round would grow with the depth";
        const std::int64_t in_registers = pool.camera != CameraStage::Staged ? scene.pixel_count() : 0;
        EXPECT_EQ(sum(deep.report, &RoundReport::records_in), deep.report.segments() - in_registers);
    }
}

TEST(DeepPaths, AmongShallowOnesMakeTheImageOfRecursion) {
    const CompiledScene<float> scene = compile<float>(small_scene("mirror_corridor", 17));
    const Rendered expected = render_recursive(scene, settings_of(1, 100'000));
    PoolSettings pool;
    pool.capacity = 64;
    const Rendered got = render_pool(scene, settings_of(1, 100'000), pool);
    EXPECT_EQ(got.hash(), expected.hash());
    EXPECT_EQ(got.report.segments(), expected.report.segments());
    EXPECT_GT(got.report.segments(), 100 * got.report.paths()) << "no path is deep";
}

class Splitting : public testing::TestWithParam<int> {};

TEST_P(Splitting, MakesTheImageOfRecursionInMemoryThatDoesNotDependOnDepthOrSamples) {
    const CompiledScene<float> scene = compile<float>(small_scene("glass_stack", 12));
    RenderSettings settings = settings_of(2, 30);
    settings.split_depth = GetParam();
    const Rendered expected = render_recursive(scene, settings);
    std::vector<Variant> all = variants();
    for (const std::int64_t batch : {1, 7, 128}) {
        for (Variant variant : variants()) {
            if (variant.pool.scope != PoolScope::Shared || variant.pool.capacity != 300) continue;
            variant.name += fmt::format(", batch {}", batch);
            variant.pool.capacity = 129;
            variant.pool.batch = batch;
            all.push_back(variant);
        }
    }
    for (const Variant& variant : all) {
        SCOPED_TRACE(variant.name);
        settings.threads = 2;
        const Rendered got = render_pool(scene, settings, variant.pool);
        EXPECT_EQ(got.hash(), expected.hash());
        EXPECT_EQ(got.report.segments(), expected.report.segments());
        RenderSettings less = settings;
        less.depth = 2;
        less.end_sample = 1;
        EXPECT_EQ(render_pool(scene, less, variant.pool).report.memory_bytes, got.report.memory_bytes);
        const std::int64_t most = std::max(variant.pool.capacity, std::int64_t{1} << settings.split_depth);
        const bool is_shared = variant.pool.scope == PoolScope::Shared;
        for (const RoundReport& round : pool_report(got.report).rounds)
            EXPECT_LE(round.records_in, is_shared ? most : 2 * most);
    }
}
INSTANTIATE_TEST_SUITE_P(Depths, Splitting, testing::Values(1, 2, 7));

}  // namespace
}  // namespace raypool::wavefront
