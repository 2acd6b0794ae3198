/// Packets and streams against single rays: the same hit to the last bit, however many rays go together.
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"
#include "tests/wavefront/random_rays.h"
#include "tests/wavefront/traversal_scenes.h"
#include "wavefront/beam.h"

namespace raypool::wavefront {
namespace {

using test::RandomInputs;

/// As the intersection stage does it: large shapes, quads, spheres.
template <class Real, class Work>
void trace_stream(const CompiledScene<ScalarOf<Real>>& scene, const std::vector<StartedRay<ScalarOf<Real>>>& rays,
                  RayStream<ScalarOf<Real>>& stream, const StreamLists<ScalarOf<Real>>& lists,
                  Intersection intersection, Work& work) {
    for (std::size_t first = 0; first < rays.size(); first += kLanes<Real>) {
        const WideRays<Real> wide = gather<Real>(rays, first);
        Hit<Real> hit;
        const std::size_t count = std::min<std::size_t>(kLanes<Real>, rays.size() - first);
        intersect_all<kEverything>(scene.large_spheres, wide, static_cast<int>(count), hit, work);
        intersect_all<kEverything>(scene.planes, wide, static_cast<int>(count), hit, work);
        for (int i = 0; i < static_cast<int>(count); ++i) {
            const std::size_t at = first + static_cast<std::size_t>(i);
            set_row(stream.rows()[at], rays[at]);
            stream.hits().set(static_cast<std::uint32_t>(at), lane(hit.t, i),
                              static_cast<std::int32_t>(lane(hit.primitive_id, i)));
        }
    }
    detail::walk_stream<kEverything, Real>(scene.quad_tree, stream.hits(), rays.size(), lists, intersection, work);
    detail::walk_stream<kEverything, Real>(scene.triangle_tree, stream.hits(), rays.size(), lists, intersection, work);
    detail::walk_stream<kEverything, Real>(scene.instance_tree, stream.hits(), rays.size(), lists, intersection, work);
    detail::walk_stream<kEverything, Real>(scene.sphere_tree, stream.hits(), rays.size(), lists, intersection, work);
}

template <class Scalar>
class RaysTogether : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RaysTogether, Scalars);

TYPED_TEST(RaysTogether, HitInStreamsOfAnyLengthWhatEachHitsAlone) {
    for (const TestScene& test : kScenes) {
        const CompiledScene<TypeParam> scene = compile<TypeParam>(test.make());
        RandomInputs random(5);
        std::size_t hits = 0;
        for (const std::size_t length : {1, 2, 7, 8, 9, 11, 12, 13, 15, 16, 17, 1000}) {
            for (std::size_t left = 4000; left >= length && left > 3000; left -= std::min<std::size_t>(left, 50)) {
                RayStream<TypeParam> stream(length);  // no longer than it must be
                const StreamLists<TypeParam> lists(length, StreamTrees(scene));
                const auto rays = random_rays(scene, length, random);
                NoTestCount work;
                const auto intersection = left % 100 == 0 ? Intersection::Pairs : Intersection::Stream;
                trace_stream<Native<TypeParam>>(scene, rays, stream, lists, intersection, work);
                for (std::size_t i = 0; i < length; ++i) {
                    const Hit<TypeParam> expected = single_hit(scene, rays[i]);
                    ASSERT_EQ(stream.primitive_id()[i], expected.primitive_id)
                        << test.name << ", ray " << i << " of " << length << ": " << rays[i].ray.origin.transpose()
                        << " + t " << rays[i].ray.direction.transpose() << ", leaving " << rays[i].leaving_id;
                    ASSERT_EQ(stream.distance()[i], expected.t) << test.name;
                    hits += expected.primitive_id != kNoPrimitive ? 1 : 0;
                }
            }
        }
        if (test.make != empty_scene) {
            EXPECT_GT(hits, 100U) << test.name;
        }
    }
}

template <class Real>
void expect_packets_hit_what_single_rays_hit() {
    for (const TestScene& test : kScenes) {
        const auto scene = compile<ScalarOf<Real>>(test.make());
        RandomInputs random(6);
        for (int round = 0; round < 300; ++round) {
            auto rays = random_rays(scene, kLanes<Real>, random);
            for (auto& start : rays) {
                start.leaving_id = kNoPrimitive;  // as camera rays do
                if (round % 2 != 0) start.ray.origin = rays[0].ray.origin;
            }
            const int count = 1 + random.below(kLanes<Real>);
            const Mask<Real> is_active = from_uint32<Real>(lane_numbers<Real>()) < Real(static_cast<float>(count));
            NoTestCount work;
            const Hit<Real> hit = closest_hits<kEverything, Real>(scene, gather<Real>(rays, 0), is_active, work);
            for (int i = 0; i < count; ++i) {
                const auto expected = single_hit(scene, rays[static_cast<std::size_t>(i)]);
                ASSERT_EQ(lane(hit.primitive_id, i), expected.primitive_id) << test.name << ", ray " << i;
                ASSERT_EQ(lane(hit.t, i), expected.t) << test.name << ", ray " << i;
            }
        }
    }
}
TYPED_TEST(RaysTogether, HitInPacketsWhatEachHitsAlone) {
    expect_packets_hit_what_single_rays_hit<Native<TypeParam>>();
}
TYPED_TEST(RaysTogether, HitInPacketsOfOneWhatEachHitsAlone) {
    expect_packets_hit_what_single_rays_hit<TypeParam>();
}

/// Beams of camera rays: from a lens, in directions that differ little or, now and then, much.
TYPED_TEST(RaysTogether, HitInBeamsWhatEachHitsAlone) {
    using Real = Native<TypeParam>;
    int coherent = 0;
    for (const TestScene& test : kScenes) {
        const auto scene = compile<TypeParam>(test.make());
        RandomInputs random(7);
        for (int round = 0; round < 300; ++round) {
            const int count = 1 + random.below(kBeamRays);
            auto rays = random_rays(scene, static_cast<std::size_t>(count), random);
            const double spread = round % 10 == 0 ? 2 : std::abs(random.magnitude<double>(-12, -1));
            const double lens = round % 2 == 0 ? 0 : 0.1 * spread;
            for (int i = 1; i < count; ++i) {
                auto& [ray, leaving_id] = rays[static_cast<std::size_t>(i)];
                ray.origin = rays[0].ray.origin + static_cast<TypeParam>(lens) * random.direction<TypeParam>();
                ray.direction = unit<TypeParam>(rays[0].ray.direction +
                                                static_cast<TypeParam>(spread) * random.direction<TypeParam>());
            }
            const int packets = (count + kLanes<Real> - 1) / kLanes<Real>;
            WideRays<Real> wide[kBeamPackets<Real>];
            Hit<Real> hit[kBeamPackets<Real>];
            for (auto& start : rays) start.leaving_id = kNoPrimitive;
            for (int p = 0; p < packets; ++p) wide[p] = gather<Real>(rays, static_cast<std::size_t>(p * kLanes<Real>));
            using Boxes = Wide<TypeParam, kTreeWidth<TypeParam>>;
            coherent += detail::Beam<Boxes>(wide, packets).is_coherent() ? 1 : 0;
            NoTestCount work;
            closest_hits<kEverything, Real>(scene, wide, hit, packets, count, work);
            for (int i = 0; i < count; ++i) {
                const auto expected = single_hit(scene, rays[static_cast<std::size_t>(i)]);
                const Hit<Real>& got = hit[i / kLanes<Real>];
                ASSERT_EQ(lane(got.primitive_id, i % kLanes<Real>), expected.primitive_id)
                    << test.name << ", ray " << i;
                ASSERT_EQ(lane(got.t, i % kLanes<Real>), expected.t) << test.name << ", ray " << i;
            }
        }
    }
    EXPECT_GT(coherent, 1000) << "of which most shall be beams";
}

TEST(Stream, CountsATestForEachRayAndNoneForTheEmptyLanes) {
    const CompiledScene<float> scene = compile<float>(one_sphere());
    for (const std::size_t length : {1, 15, 16, 17, 33}) {
        std::vector<StartedRay<float>> rays(length);
        for (auto& start : rays) start = {{vec3<float>(1, 2, 9), vec3<float>(0, 0, -1), 0}, kNoPrimitive};
        RayStream<float> stream(length);
        const StreamLists<float> lists(length, StreamTrees(scene));
        TestCount work;
        trace_stream<Native<float>>(scene, rays, stream, lists, Intersection::Pairs, work);
        EXPECT_EQ(work.primitive_tests, static_cast<std::int64_t>(length));
        EXPECT_LE(work.box_tests, static_cast<std::int64_t>(length));  // none where the sphere is outside the tree
        EXPECT_EQ(stream.distance()[length - 1], 4);
    }
}

}  // namespace
}  // namespace raypool::wavefront
