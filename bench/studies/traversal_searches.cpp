#include "bench/studies/traversal_searches.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "core/runtime/engine.h"
#include "wavefront/intersect_stage.h"
#include "wavefront/packet.h"
#include "wavefront/shadow_stage.h"

namespace raypool::studies {

namespace {

using Lanes = stdx::native_simd<float>;
using LaneIds = stdx::rebind_simd_t<std::int32_t, Uint32<Lanes>>;
constexpr std::size_t kRays = kLanes<Lanes>;

/// Calls trace(i, rays, their number) for each register of rays.
template <class Trace>
void for_each_register(const RecordedRays& rays, std::size_t first, std::size_t end, Trace trace) {
    for (std::size_t i = first; i < end; i += kRays) trace(i, rays.records.load<Lanes>(i), std::min(kRays, end - i));
}
constexpr unsigned first_bits(std::size_t count) {
    return (1U << count) - 1;
}

/// The lights of shadow rays i, i + 1, ...
Hit<Lanes> lights_of(const RecordedRays& rays, std::size_t i) {
    return {Lanes(&rays.light_t[i], stdx::element_aligned),
            stdx::static_simd_cast<Int<Lanes>>(LaneIds(&rays.light_id[i], stdx::element_aligned))};
}

void put_hits(RayAnswers& answers, std::size_t i, const Hit<Lanes>& hit, std::size_t count) {
    alignas(64) float t[kRays];
    alignas(64) std::int32_t id[kRays];
    hit.t.copy_to(t, stdx::vector_aligned);
    stdx::static_simd_cast<LaneIds>(hit.primitive_id).copy_to(id, stdx::vector_aligned);
    std::memcpy(&answers.distance[i], t, count * sizeof(float));
    std::memcpy(&answers.primitive_id[i], id, count * sizeof(std::int32_t));
}

/// By whatever finds hits for a `Work`, as the tracer of recursion does.
template <class Work>
void trace_single_rays(const SceneView<float>& scene, const RecordedRays& rays, RayAnswers& answers, Work work) {
    const FlushDenormals flush;
    for (std::size_t i = 0; i < rays.count; ++i) {
        const auto record = rays.records.load<float>(i);
        const auto leaving_id = static_cast<std::int32_t>(record.leaving_id);
        if (rays.are_shadow) {
            const Occlusion<float> light{rays.light_t[i], rays.light_id[i]};
            answers.primitive_id[i] = is_occluded<kEverything>(scene, record.ray, leaving_id, light, work) ? 1 : 0;
        } else {
            const Hit<float> hit = closest_hit<kEverything>(scene, record.ray, leaving_id, work);
            answers.distance[i] = hit.t;
            answers.primitive_id[i] = static_cast<std::int32_t>(hit.primitive_id);
        }
    }
}

RaySearch packets(const CompiledScene<float>& scene) {
    return [&scene](const RecordedRays& rays, RayAnswers& answers) {
        const FlushDenormals flush;
        NoTestCount nothing;
        for_each_register(rays, 0, rays.count, [&](std::size_t i, const auto& record, std::size_t count) {
            const auto wide = wavefront::wide_rays<Lanes>(record.ray, record.leaving_id);
            const Mask<Lanes> is_active = lanes_before<Lanes>(count);
            put_hits(answers, i, wavefront::closest_hits<kEverything, Lanes>(scene, wide, is_active, nothing), count);
        });
    };
}

/// The stages of the pool that trace rays, with batches of up to `capacity` records.
class Streams {
    using Stream = wavefront::RayStream<float>;

  public:
    Streams(const CompiledScene<float>& scene, std::size_t capacity)
        : capacity_(capacity),
          lists_(capacity + kRays, wavefront::StreamTrees(scene)),
          intersect_(scene, wavefront::Intersection::Pairs, capacity, lists_),
          shadow_(scene, wavefront::Intersection::Pairs, capacity + kRays, lists_) {
        seen_.reserve(capacity + kRays);
    }

    void trace(const RecordedRays& rays, RayAnswers& answers) {
        const FlushDenormals flush;
        for (std::size_t first = 0; first < rays.count; first += capacity_) {
            const std::size_t end = std::min(first + capacity_, rays.count);
            if (rays.are_shadow) {
                trace_shadow_rays(rays, answers, first, end);
            } else {
                intersect_.run(rays.records, first, end - first);
                std::copy_n(intersect_.stream().distance(), end - first, &answers.distance[first]);
                std::copy_n(intersect_.stream().primitive_id(), end - first, &answers.primitive_id[first]);
            }
        }
    }

  private:
    /// What a ray brings is for the cell of its number: those that bring nothing are hidden.
    void trace_shadow_rays(const RecordedRays& rays, RayAnswers& answers, std::size_t first, std::size_t end) {
        NoTestCount nothing;
        for_each_register(rays, first, end, [&](std::size_t i, const auto& record, std::size_t count) {
            Scattered<Lanes> out{};
            out.start = {record.ray.origin, wavefront::signed_ids<Lanes>(record.leaving_id)};
            const Hit<Lanes> light = lights_of(rays, i);
            LightPart<Lanes> lights;
            lights.light.direction = record.ray.direction;
            lights.light.t = light.t;
            lights.light.primitive_id = light.primitive_id;
            lights.radiance = vec3<Lanes>(Lanes(1), Lanes(1), Lanes(1));
            const auto cell = lane_numbers<Lanes>() + Uint32<Lanes>(static_cast<std::uint32_t>(i));
            shadow_.add(record, out, lights, cell, first_bits(count), nothing);
        });
        seen_.clear();
        shadow_.run(seen_, nothing);
        std::fill(answers.primitive_id.begin() + static_cast<std::ptrdiff_t>(first),
                  answers.primitive_id.begin() + static_cast<std::ptrdiff_t>(end), 1);
        for (std::size_t i = 0; i < seen_.count(); ++i) answers.primitive_id[seen_.pixel(i)] = 0;
    }

    std::size_t capacity_;
    wavefront::StreamLists<float> lists_;
    wavefront::IntersectStage<kEverything, Lanes, NoTestCount> intersect_;
    wavefront::ShadowStage<kEverything, Lanes, NoTestCount> shadow_;
    wavefront::Contributions<float> seen_;
};

RaySearch streams(const CompiledScene<float>& scene, std::size_t capacity) {
    return [made = std::make_shared<Streams>(scene, capacity)](const RecordedRays& rays, RayAnswers& answers) {
        made->trace(rays, answers);
    };
}

#ifdef RAYPOOL_HAS_EMBREE
template <class Real>
std::shared_ptr<const peers::EmbreeScene> own_triangles(const CompiledScene<float>& scene,
                                                        const peers::EmbreeBuild& build = {}) {
    return std::make_shared<const peers::EmbreeScene>(scene, peers::ShapeFunctions::make<kEverything, Real>(),
                                                      peers::EmbreeTriangles::Embrees, build);
}

RaySearch embree_packets(const CompiledScene<float>& scene) {
    return [&scene, embree = own_triangles<Lanes>(scene)](const RecordedRays& rays, RayAnswers& answers) {
        const FlushDenormals flush;
        const auto flags =
            rays.are_camera ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        for_each_register(rays, 0, rays.count, [&](std::size_t i, const auto& record, std::size_t count) {
            const Int<Lanes> leaving_id = wavefront::signed_ids<Lanes>(record.leaving_id);
            const Mask<Lanes> is_active = lanes_before<Lanes>(count);
            if (rays.are_shadow) {
                const unsigned hidden = mask_bits(peers::are_occluded<kEverything>(
                    *embree, scene, record.ray, leaving_id, lights_of(rays, i), is_active));
                for (std::size_t k = 0; k < count; ++k)
                    answers.primitive_id[i + k] = static_cast<std::int32_t>(hidden >> k & 1U);
            } else {
                const Hit<Lanes> hit =
                    peers::closest_hits<kEverything>(*embree, scene, record.ray, leaving_id, is_active, flags);
                put_hits(answers, i, hit, count);
            }
        });
    };
}
#endif

}  // namespace

RaySearch single_rays(const SceneView<float>& scene) {
    return [&scene](const RecordedRays& rays, RayAnswers& answers) {
        trace_single_rays(scene, rays, answers, NoTestCount{});
    };
}

#ifdef RAYPOOL_HAS_EMBREE
std::shared_ptr<const peers::EmbreeScene> embree_scene(const CompiledScene<float>& scene,
                                                       const peers::EmbreeBuild& build) {
    return own_triangles<float>(scene, build);
}

RaySearch embree_single_rays(const CompiledScene<float>& scene, std::shared_ptr<const peers::EmbreeScene> embree) {
    return [&scene, embree = std::move(embree)](const RecordedRays& rays, RayAnswers& answers) {
        trace_single_rays(scene, rays, answers, peers::EmbreeSearch{{}, embree.get()});
    };
}
#endif

std::vector<NamedSearch> named_searches(const std::vector<std::size_t>& stream_capacities) {
    std::vector<NamedSearch> searches{{kSingleRays, true, true, single_rays}, {"packets", true, false, packets}};
    for (const std::size_t capacity : stream_capacities)
        searches.push_back({fmt::format("streams of {}", capacity), true, true,
                            [capacity](const CompiledScene<float>& scene) { return streams(scene, capacity); }});
#ifdef RAYPOOL_HAS_EMBREE
    searches.push_back({"Embree, single rays", false, true, [](const CompiledScene<float>& scene) {
                            return embree_single_rays(scene, own_triangles<float>(scene));
                        }});
    searches.push_back({"Embree, packets", false, true, embree_packets});
#endif
    return searches;
}

}  // namespace raypool::studies
