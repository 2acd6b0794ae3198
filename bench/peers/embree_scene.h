/// A compiled scene in Embree 3: the shapes of our trees as user geometries, which Embree's traversal leads to and our
/// kernels test. Large spheres and planes, which are in no tree, are tested before, as every engine does.
///
/// Called by the tracers of bench/peers/. Immutable once made, and safe to trace from several threads.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <type_traits>
#include <vector>

#include "core/shading/compiled_scene.h"
#include "wavefront/wide_rays.h"

namespace raypool::peers {

/// A packet: as many rays as fill a register, 16 with AVX-512, else 8.
using Packet = stdx::native_simd<float>;

/// Embree's rays and their hits, of a float or a Packet. Of the hit, primID is used: the id of the closest primitive.
template <class Real>
using RayHit =
    std::conditional_t<kLanes<Real> == 1, RTCRayHit, std::conditional_t<kLanes<Real> == 16, RTCRayHit16, RTCRayHit8>>;

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
};

/// Spheres or quads, each a block by itself, so that a test reads a line or two of the cache.
template <class Block>
struct Shapes {
    std::vector<Block> blocks;
    float room;  ///< that their boxes leave for Embree's rounding
};

/// What Embree calls for a shape, by its kind.
struct ShapeFunctions {
    RTCIntersectFunctionN sphere;
    RTCIntersectFunctionN quad;

    template <Features features, class Real>
    static ShapeFunctions make() {
        return {intersect<features, Real, SphereBlock<float, 1>>, intersect<features, Real, PlanarBlock<float, 1>>};
    }

  private:
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
            reinterpret_cast<const Query<Real>*>(args->context)->rays, hit);
        if (none(is_closer)) return;
        set(rayhit.ray.tfar, select(is_closer, hit.t, t));
        set(rayhit.hit.primID, hit.primitive_id);
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
        const Ray<Real>& ray = query.rays.ray;
        RayHit<Real> rayhit;
        set(rayhit.ray.org_x, ray.origin[0]), set(rayhit.ray.dir_x, ray.direction[0]);
        set(rayhit.ray.org_y, ray.origin[1]), set(rayhit.ray.dir_y, ray.direction[1]);
        set(rayhit.ray.org_z, ray.origin[2]), set(rayhit.ray.dir_z, ray.direction[2]);
        set(rayhit.ray.tnear, Real(0)), set(rayhit.ray.tfar, hit.t), set(rayhit.ray.time, ray.time);
        set(rayhit.ray.mask, Int<Real>(-1)), set(rayhit.ray.flags, Int<Real>(0));
        set(rayhit.hit.primID, hit.primitive_id);
        rtcInitIntersectContext(&query.context);
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

  private:
    template <class Block>
    void attach(Shapes<Block>& shapes, bool can_move, RTCIntersectFunctionN intersect);

    template <auto release>
    struct Release {
        void operator()(auto handle) const { release(handle); }
    };

    Shapes<SphereBlock<float, 1>> spheres_;
    Shapes<PlanarBlock<float, 1>> quads_;
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
