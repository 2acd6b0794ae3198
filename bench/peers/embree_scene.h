/// A compiled scene in Embree 3: the shapes of our trees as user geometries, which Embree's traversal leads to and our
/// kernels test. Large spheres and planes, which are in no tree, are tested before, as every engine does.
///
/// Called by the tracers of bench/peers/. Immutable once made, and safe to trace from several threads.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <type_traits>
#include <vector>

#include "core/geometry/occlusion.h"
#include "core/shading/compiled_scene.h"
#include "wavefront/wide_rays.h"

namespace raypool::peers {

/// A packet: as many rays as fill a register, 16 with AVX-512, else 8.
using Packet = stdx::native_simd<float>;

/// Embree's rays and their hits, of a float or a Packet. Of the hit, primID is used: the id of the closest primitive.
template <class Real>
using RayHit =
    std::conditional_t<kLanes<Real> == 1, RTCRayHit, std::conditional_t<kLanes<Real> == 16, RTCRayHit16, RTCRayHit8>>;
/// Its rays toward lights.
template <class Real>
using ShadowRay =
    std::conditional_t<kLanes<Real> == 1, RTCRay, std::conditional_t<kLanes<Real> == 16, RTCRay16, RTCRay8>>;

/// A field of these as the kernels take it.
template <class T>
RAYPOOL_INLINE T get(const auto& field) {
    return std::bit_cast<T>(field);
}
template <class T>
RAYPOOL_INLINE void set(auto& field, const T& value) {
    static_assert(sizeof(field) == sizeof(value));
    std::memcpy(&field, &value, sizeof(field));
}

/// What a call of Embree hands on to the kernels: Embree knows the context alone, which comes first.
template <class Real>
struct Query {
    RTCIntersectContext context;
    wavefront::WideRays<Real> rays;
    Hit<Real> light{};  ///< of shadow rays: what they are to reach
};

/// Spheres, quads or triangles, each a block by itself, so that a test reads a line or two of the cache.
template <class Block>
struct Shapes {
    std::vector<Block> blocks;
    float room;  ///< that their boxes leave for Embree's rounding
};

/// What Embree calls for a shape, by its kind.
struct ShapeFunctions {
    struct OfKind {
        RTCIntersectFunctionN intersect;
        RTCOccludedFunctionN occlude;
    };
    OfKind sphere;
    OfKind quad;
    OfKind triangle;

    template <Features features, class Real>
    static ShapeFunctions make() {
        return {of_kind<features, Real, SphereBlock<float, 1>>(), of_kind<features, Real, PlanarBlock<float, 1>>(),
                of_kind<features, Real, TriangleBlock<float, 1>>()};
    }

  private:
    template <Features features, class Real, class Block>
    static OfKind of_kind() {
        return {intersect<features, Real, Block>, occlude<features, Real, Block>};
    }

    /// Tests a shape against the rays that Embree says are valid.
    template <Features features, class Real, class Block>
    static void intersect(const RTCIntersectFunctionNArguments* args) {
        auto& rayhit = *reinterpret_cast<RayHit<Real>*>(args->rayhit);
        const auto t = get<Real>(rayhit.ray.tfar);
        Hit<Real> hit{t, get<Int<Real>>(rayhit.hit.primID)};
        if constexpr (Simd<Real>) {  // nothing is closer than 0
            const Int<Real> valid(args->valid, stdx::element_aligned);
            hit.t = select(as_mask<Real>(valid != Int<Real>(0)), t, Real(0));
        }
        const Mask<Real> is_closer = wavefront::intersect_lane<features, InBox::Yes, Real>(
            static_cast<const Shapes<Block>*>(args->geometryUserPtr)->blocks[args->primID], 0,
            wavefront::ready_for<Block, Real>(reinterpret_cast<const Query<Real>*>(args->context)->rays), hit);
        if (none(is_closer)) return;
        set(rayhit.ray.tfar, select(is_closer, hit.t, t));
        set(rayhit.hit.primID, hit.primitive_id);
    }

    /// Whether a shape hides the lights of the shadow rays that Embree says are valid: that of `Occlusion`, for a
    /// register.
    template <Features features, class Real, class Block>
    static void occlude(const RTCOccludedFunctionNArguments* args) {
        auto& ray = *reinterpret_cast<ShadowRay<Real>*>(args->ray);
        const auto& query = *reinterpret_cast<const Query<Real>*>(args->context);
        const Block& shape = static_cast<const Shapes<Block>*>(args->geometryUserPtr)->blocks[args->primID];
        Hit<Real> hit = query.light;
        if constexpr (Simd<Real>) {
            const Int<Real> valid(args->valid, stdx::element_aligned);
            hit.t = select(as_mask<Real>(valid != Int<Real>(0)), hit.t, Real(0));
        }
        const Mask<Real> is_before = wavefront::intersect_lane<features, InBox::Yes, Real>(
                                         shape, 0, wavefront::ready_for<Block, Real>(query.rays), hit) &&
                                     as_mask<Real>(query.light.primitive_id != Int<Real>(shape.id[0]));
        if (none(is_before)) return;
        set(ray.tfar, select(is_before, Real(-kInfinity<float>), get<Real>(ray.tfar)));
    }
};

class EmbreeScene {
  public:
    EmbreeScene(const CompiledScene<float>& scene, const ShapeFunctions& functions);
    EmbreeScene(const EmbreeScene&) = delete;  // Embree points into it
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene() = default;

    /// The closest hits, `hit` or closer, of the rays whose `valid` is not 0.
    template <class Real>
    RAYPOOL_INLINE Hit<Real> closest(Query<Real>& query, const Hit<Real>& hit, const Int<Real>& valid) const {
        RayHit<Real> rayhit;
        start<Real>(query, hit.t, rayhit.ray);
        set(rayhit.hit.primID, hit.primitive_id);
        alignas(64) std::int32_t is_valid[kLanes<Real>];
        set(is_valid, valid);
        if constexpr (kLanes<Real> == 1) {
            rtcIntersect1(scene_.get(), &query.context, &rayhit);
        } else if constexpr (kLanes<Real> == 16) {
            rtcIntersect16(is_valid, scene_.get(), &query.context, &rayhit);
        } else {
            rtcIntersect8(is_valid, scene_.get(), &query.context, &rayhit);
        }
        return {get<Real>(rayhit.ray.tfar), get<Int<Real>>(rayhit.hit.primID)};
    }

    /// Which of the rays whose `valid` is not 0 meet something before query.light.
    template <class Real>
    RAYPOOL_INLINE Mask<Real> occluded(Query<Real>& query, const Int<Real>& valid) const {
        ShadowRay<Real> ray;
        start<Real>(query, query.light.t, ray);
        alignas(64) std::int32_t is_valid[kLanes<Real>];
        set(is_valid, valid);
        if constexpr (kLanes<Real> == 1) {
            rtcOccluded1(scene_.get(), &query.context, &ray);
        } else if constexpr (kLanes<Real> == 16) {
            rtcOccluded16(is_valid, scene_.get(), &query.context, &ray);
        } else {
            rtcOccluded8(is_valid, scene_.get(), &query.context, &ray);
        }
        return get<Real>(ray.tfar) < Real(0);
    }

  private:
    /// Sets the rays that Embree is to follow up to `end`.
    template <class Real>
    RAYPOOL_INLINE static void start(Query<Real>& query, const Real& end, auto& to) {
        const Ray<Real>& ray = query.rays.ray;
        set(to.org_x, ray.origin[0]), set(to.dir_x, ray.direction[0]);
        set(to.org_y, ray.origin[1]), set(to.dir_y, ray.direction[1]);
        set(to.org_z, ray.origin[2]), set(to.dir_z, ray.direction[2]);
        set(to.tnear, Real(0)), set(to.tfar, end), set(to.time, ray.time);
        set(to.mask, Int<Real>(-1)), set(to.flags, Int<Real>(0));
        rtcInitIntersectContext(&query.context);
    }
    template <class Block>
    void attach(Shapes<Block>& shapes, bool can_move, const ShapeFunctions::OfKind& functions);

    template <auto release>
    struct Release {
        void operator()(auto handle) const { release(handle); }
    };

    Shapes<SphereBlock<float, 1>> spheres_;
    Shapes<PlanarBlock<float, 1>> quads_;
    Shapes<TriangleBlock<float, 1>> triangles_;
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release<rtcReleaseDevice>> device_;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, Release<rtcReleaseScene>> scene_;
};

/// What the tracer of recursive/ has for a count of tests here.
struct EmbreeSearch : NoTestCount {
    const EmbreeScene* embree = nullptr;
};

/// The closest hit of one ray.
template <Features features>
[[gnu::noinline]] Hit<float> closest_hit(const SceneView<float>& scene, const Ray<float>& ray, std::int32_t leaving_id,
                                         EmbreeSearch& search) {
    using Shapes = Wide<float, kTreeWidth<float>>;
    Query<float> query{{}, {ray, ray_inverse<float>(ray.direction), leaving_id}};
    const SpreadRay<Shapes> spread(ray, query.rays.inverse, leaving_id);
    Hit<float> hit;
    raypool::detail::test_untreed<features, Shapes>(scene, spread, hit, search);
    return search.embree->closest<float>(query, hit, -1);
}

/// Whether anything lies before a light that one ray is to reach.
template <Features features>
[[gnu::noinline]] bool is_occluded(const SceneView<float>& scene, const Ray<float>& ray, std::int32_t leaving_id,
                                   Occlusion<float> light, EmbreeSearch& search) {
    using Shapes = Wide<float, kTreeWidth<float>>;
    Query<float> query{{}, {ray, ray_inverse<float>(ray.direction), leaving_id}, {light.t, light.light_id}};
    const SpreadRay<Shapes> spread(ray, query.rays.inverse, leaving_id);
    raypool::detail::test_untreed<features, Shapes>(scene, spread, light, search);
    return light.is_hidden || search.embree->occluded<float>(query, -1);
}

/// Which of the rays in `is_active` meet something before their lights; what is said of the others means nothing.
template <Features features>
RAYPOOL_INLINE Mask<Packet> are_occluded(const EmbreeScene& embree, const SceneView<float>& scene,
                                         const Ray<Packet>& ray, const Int<Packet>& leaving_id,
                                         const Hit<Packet>& light, const Mask<Packet>& is_active) {
    Query<Packet> query{{}, {ray, ray_inverse<Packet>(ray.direction), leaving_id}, light};
    NoTestCount work;
    Mask<Packet> is_hidden =
        wavefront::hidden_by_any<features>(scene.large_spheres, query.rays, kLanes<Packet>, light, work);
    if constexpr (features.planar)
        is_hidden =
            is_hidden || wavefront::hidden_by_any<features>(scene.planes, query.rays, kLanes<Packet>, light, work);
    return is_hidden ||
           embree.occluded<Packet>(query, select(is_active && !is_hidden, Int<Packet>(-1), Int<Packet>(0)));
}

/// The closest hits of the rays in `is_active`; those of the others mean nothing.
template <Features features>
RAYPOOL_INLINE Hit<Packet> closest_hits(const EmbreeScene& embree, const SceneView<float>& scene,
                                        const Ray<Packet>& ray, const Int<Packet>& leaving_id,
                                        const Mask<Packet>& is_active) {
    Query<Packet> query{{}, {ray, ray_inverse<Packet>(ray.direction), leaving_id}};
    Hit<Packet> hit;
    NoTestCount work;
    wavefront::intersect_all<features>(scene.large_spheres, query.rays, kLanes<Packet>, hit, work);
    if constexpr (features.planar)
        wavefront::intersect_all<features>(scene.planes, query.rays, kLanes<Packet>, hit, work);
    return embree.closest<Packet>(query, hit, select(is_active, Int<Packet>(-1), Int<Packet>(0)));
}

}  // namespace raypool::peers
