/// What hides a light from a shadow ray: single rays and streams against every shape, asked one by one.
#include "core/geometry/any_hit.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/geometry/brute_force.h"
#include "tests/wavefront/random_rays.h"
#include "tests/wavefront/traversal_scenes.h"

namespace raypool::wavefront {
namespace {

using test::RandomInputs;

template <class Scalar>
struct ShadowRay {
    StartedRay<Scalar> start;
    Occlusion<Scalar> light;
    bool is_hidden;  ///< by brute force
};

/// Rays toward what they meet first, second, ... or never, at its own distance or where it is taken to be by rounding,
/// and toward what is behind everything.
template <class Scalar>
std::vector<ShadowRay<Scalar>> shadow_rays(const CompiledScene<Scalar>& scene, std::size_t count,
                                           RandomInputs& random) {
    std::vector<ShadowRay<Scalar>> rays;
    for (const StartedRay<Scalar>& start : random_rays(scene, count, random)) {
        std::vector<std::pair<Scalar, std::int32_t>> hits;
        test::for_each_distance<Scalar>(scene, start.ray, start.leaving_id, [&](Scalar t, std::int32_t id) {
            if (t < kInfinity<Scalar>) hits.emplace_back(t, id);
        });
        Occlusion<Scalar> light{kInfinity<Scalar>, kNoPrimitive};
        if (!hits.empty() && !random.one_in(4)) {
            std::sort(hits.begin(), hits.end());
            const auto& [t, id] =
                hits[static_cast<std::size_t>(random.below(random.one_in(2) ? 1 : static_cast<int>(hits.size())))];
            light = {random.one_in(3) ? t * static_cast<Scalar>(random.uniform(0.999, 1.001)) : t, id};
        }
        bool is_hidden = false;
        for (const auto& [t, id] : hits) is_hidden = is_hidden || light.hides(t, id);
        rays.push_back({start, light, is_hidden});
    }
    return rays;
}

/// As the shadow stage does it: large shapes while the rays are in a register, then quads, then spheres.
template <class Real>
std::vector<bool> hidden_in_stream(const CompiledScene<ScalarOf<Real>>& scene,
                                   const std::vector<ShadowRay<ScalarOf<Real>>>& rays, Intersection intersection) {
    using Scalar = ScalarOf<Real>;
    NoTestCount work;
    RayStream<Scalar> stream(rays.size());
    const StreamLists<Scalar> lists(rays.size(), StreamTrees(scene));
    const ShadowHits<Scalar> hits{stream.hits()};
    std::vector<StartedRay<Scalar>> starts;
    for (const auto& ray : rays) starts.push_back(ray.start);
    for (std::size_t first = 0; first < rays.size(); first += kLanes<Real>) {
        const WideRays<Real> wide = gather<Real>(starts, first);
        const std::size_t count = std::min<std::size_t>(kLanes<Real>, rays.size() - first);
        Hit<Real> light;
        for (int i = 0; i < static_cast<int>(count); ++i) {
            set_lane(light.t, i, rays[first + static_cast<std::size_t>(i)].light.t);
            set_lane(light.primitive_id, i, rays[first + static_cast<std::size_t>(i)].light.light_id);
        }
        const auto lanes = static_cast<int>(count);
        const unsigned hidden = mask_bits(hidden_by_any<kEverything>(scene.large_spheres, wide, lanes, light, work)) |
                                mask_bits(hidden_by_any<kEverything>(scene.planes, wide, lanes, light, work));
        for (int i = 0; i < lanes; ++i) {
            const std::size_t at = first + static_cast<std::size_t>(i);
            set_row(stream.rows()[at], starts[at]);
            hits.set(static_cast<std::uint32_t>(at), rays[at].light.t, rays[at].light.light_id);
            if ((hidden >> i & 1U) != 0) hits.hide(static_cast<std::uint32_t>(at));
        }
    }
    detail::walk_stream<kEverything, Real>(scene.quad_tree, hits, rays.size(), lists, intersection, work);
    detail::walk_stream<kEverything, Real>(scene.triangle_tree, hits, rays.size(), lists, intersection, work);
    detail::walk_stream<kEverything, Real>(scene.instance_tree, hits, rays.size(), lists, intersection, work);
    detail::walk_stream<kEverything, Real>(scene.sphere_tree, hits, rays.size(), lists, intersection, work);
    std::vector<bool> is_hidden(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) is_hidden[i] = hits.is_hidden(static_cast<std::uint32_t>(i));
    return is_hidden;
}

template <class Scalar>
class ShadowRays : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(ShadowRays, Scalars);

// Brute force is slow where sanitizers look on.
#ifdef NDEBUG
constexpr int kTurns = 6;
constexpr std::size_t kLengths[] = {1, 5, 12, 16, 17, 300, 1000};
constexpr int kLeast = 100;  // of either kind
#else
constexpr int kTurns = 2;
constexpr std::size_t kLengths[] = {1, 5, 12, 16, 17, 300};
constexpr int kLeast = 25;
#endif

TYPED_TEST(ShadowRays, AreHiddenByWhatBruteForceSays) {
    for (const TestScene& test : kScenes) {
        const CompiledScene<TypeParam> scene = compile<TypeParam>(test.make());
        RandomInputs random(6);
        int counts[2] = {};
        for (const std::size_t length : kLengths) {
            for (int turn = 0; turn < kTurns; ++turn) {
                const auto rays = shadow_rays(scene, length, random);
                const auto intersection = turn % 2 == 0 ? Intersection::Pairs : Intersection::Stream;
                const std::vector<bool> in_stream = hidden_in_stream<Native<TypeParam>>(scene, rays, intersection);
                for (std::size_t i = 0; i < length; ++i) {
                    const ShadowRay<TypeParam>& ray = rays[i];
                    NoTestCount work;
                    ASSERT_EQ(is_occluded<kEverything>(scene, ray.start.ray, ray.start.leaving_id, ray.light, work),
                              ray.is_hidden)
                        << test.name << ", ray " << i << " of " << length;
                    ASSERT_EQ(in_stream[i], ray.is_hidden) << test.name << ", ray " << i << " of " << length;
                    ++counts[ray.is_hidden ? 1 : 0];
                }
            }
        }
        EXPECT_GT(counts[0], kLeast) << test.name;
        if (test.make != empty_scene && test.make != one_sphere) {
            EXPECT_GT(counts[1], kLeast) << test.name;
        }
    }
}

}  // namespace
}  // namespace raypool::wavefront
