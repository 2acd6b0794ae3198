/// A compiled scene in Embree 3: the shapes of our trees as user geometries, which Embree's traversal leads to and our
/// kernels test; triangles, if one likes, as Embree's own. Large spheres and planes, which are in no tree, are tested
/// before, as every engine does.
///
/// Called by the tracers of bench/peers/. Immutable once made, and safe to trace from several threads.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "bench/peers/embree_calls.h"
#include "bench/peers/embree_device.h"
#include "core/geometry/any_hit.h"
#include "core/geometry/wide_rays.h"
#include "core/shading/compiled_scene.h"

namespace raypool::peers {

/// Whose test finds the hits on triangles.
enum class EmbreeTriangles : bool {
    Ours,     ///< user geometries, as all other shapes: every hit is ours, to the bit
    Embrees,  ///< RTC_GEOMETRY_TYPE_TRIANGLE, by default in a robust scene: closed along edges, and distances are
              ///< rounded in another way
};

/// What a call of Embree hands on to the kernels: Embree knows the context alone, which comes first.
template <class Real>
struct Query {
    RTCIntersectContext context;
    WideRays<Real> rays;
    Hit<Real> light{};                                                       ///< of shadow rays: what they are to reach
    RTCIntersectContextFlags flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;  ///< how Embree walks with packets
};

/// geomID of rays that met nothing, or a shape that our kernels test.
inline constexpr std::int32_t kNoGeometry = -1;
static_assert(kNoGeometry == static_cast<std::int32_t>(RTC_INVALID_GEOMETRY_ID));

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
    RTCFilterFunctionN pass_light;  ///< of Embree's own triangles

    template <Features features, class Real>
    static ShapeFunctions make() {
        return {of_kind<features, Real, SphereBlock<float, 1>>(), of_kind<features, Real, PlanarBlock<float, 1>>(),
                of_kind<features, Real, TriangleBlock<float, 1>>(), pass_light_of<Real>};
    }

  private:
    template <Features features, class Real, class Block>
    static OfKind of_kind() {
        return {intersect<features, Real, Block>, occlude<features, Real, Block>};
    }

    /// Lets shadow rays through the triangle that is their light.
    template <class Real>
    static void pass_light_of(const RTCFilterFunctionNArguments* args) {
        const auto& query = *reinterpret_cast<const Query<Real>*>(args->context);
        const std::int32_t first_triangle = *static_cast<const std::int32_t*>(args->geometryUserPtr);
        for (unsigned i = 0; i < args->N; ++i) {
            const auto number = static_cast<std::int32_t>(RTCHitN_primID(args->hit, args->N, i));
            if (first_triangle + number == lane(query.light.primitive_id, static_cast<int>(i))) args->valid[i] = 0;
        }
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
        const Mask<Real> is_closer = intersect_lane<features, InBox::Yes, Real>(
            static_cast<const Shapes<Block>*>(args->geometryUserPtr)->blocks[args->primID], 0,
            ready_for<Block, Real>(reinterpret_cast<const Query<Real>*>(args->context)->rays), hit);
        if (none(is_closer)) return;
        set(rayhit.ray.tfar, select(is_closer, hit.t, t));
        set(rayhit.hit.primID, hit.primitive_id);
        const auto geometry = get<Int<Real>>(rayhit.hit.geomID);
        set(rayhit.hit.geomID, select(is_closer, Int<Real>(kNoGeometry), geometry));
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
        const Mask<Real> is_before =
            intersect_lane<features, InBox::Yes, Real>(shape, 0, ready_for<Block, Real>(query.rays), hit) &&
            as_mask<Real>(query.light.primitive_id != Int<Real>(shape.id[0]));
        if (none(is_before)) return;
        set(ray.tfar, select(is_before, Real(-kInfinity<float>), get<Real>(ray.tfar)));
    }
};

/// How Embree builds its trees. Where a scene of its own triangles is robust, its high quality is its medium one: it
/// splits no triangles between leaves.
struct EmbreeBuild {
    RTCSceneFlags flags = RTC_SCENE_FLAG_ROBUST;  ///< of a scene of its own triangles
    int threads = 1;                              ///< embree_device() says which there are in the end
};

/// Embree reads the vertices of the compiled scene, which outlives this, where triangles are its own.
class EmbreeScene {
  public:
    /// Throws std::runtime_error where Embree fails.
    EmbreeScene(const CompiledScene<float>& scene, const ShapeFunctions& functions, EmbreeTriangles triangles,
                const EmbreeBuild& build = {});
    EmbreeScene(const EmbreeScene&) = delete;  // Embree points into it
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene() = default;

    /// Seconds that rtcCommitScene took.
    [[nodiscard]] double build_seconds() const { return build_seconds_; }
    /// What Embree says that it keeps. The vertices, and which a triangle has, are ours.
    [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(bytes_); }

    /// The closest hits, `hit` or closer, of the rays whose `valid` is not 0.
    template <class Real>
    RAYPOOL_INLINE Hit<Real> closest(Query<Real>& query, const Hit<Real>& hit, const Int<Real>& valid) const {
        RayHit<Real> rayhit;
        set(rayhit.hit.primID, hit.primitive_id);
        set(rayhit.hit.geomID, Int<Real>(kNoGeometry));
        trace<Real>(query, hit.t, valid, rayhit, rayhit.ray);
        const Mask<Real> is_triangle = as_mask<Real>(get<Int<Real>>(rayhit.hit.geomID) != Int<Real>(kNoGeometry));
        const Int<Real> first = select(is_triangle, Int<Real>(first_triangle_), Int<Real>(0));
        return {get<Real>(rayhit.ray.tfar), first + get<Int<Real>>(rayhit.hit.primID)};
    }

    /// Which of the rays whose `valid` is not 0 meet something before query.light.
    template <class Real>
    RAYPOOL_INLINE Mask<Real> occluded(Query<Real>& query, const Int<Real>& valid) const {
        ShadowRay<Real> ray;
        trace<Real>(query, query.light.t, valid, ray, ray);
        return get<Real>(ray.tfar) < Real(0);
    }

  private:
    /// Has Embree follow the rays up to `end`. `ray` is those in `to`, or `to` itself.
    template <class Real>
    RAYPOOL_INLINE void trace(Query<Real>& query, const Real& end, const Int<Real>& valid, auto& to, auto& ray) const {
        const auto& [origin, direction, time] = query.rays.ray;
        set(ray.org_x, origin[0]), set(ray.dir_x, direction[0]);
        set(ray.org_y, origin[1]), set(ray.dir_y, direction[1]);
        set(ray.org_z, origin[2]), set(ray.dir_z, direction[2]);
        set(ray.tnear, Real(0)), set(ray.tfar, end), set(ray.time, time);
        set(ray.mask, Int<Real>(-1)), set(ray.flags, Int<Real>(0));
        rtcInitIntersectContext(&query.context);
        query.context.flags = query.flags;
        alignas(64) std::int32_t is_valid[kLanes<Real>];
        set(is_valid, valid);
        EmbreeCalls<kLanes<Real>>::trace(is_valid, scene_.get(), &query.context, &to);
    }
    void attach_triangles(const CompiledScene<float>& scene, RTCSceneFlags flags, RTCFilterFunctionN pass_light);
    template <class Block>
    void attach(Shapes<Block>& shapes, bool can_move, const ShapeFunctions::OfKind& functions);
    void finish(RTCGeometry geometry);

    Shapes<SphereBlock<float, 1>> spheres_;
    Shapes<PlanarBlock<float, 1>> quads_;
    Shapes<TriangleBlock<float, 1>> triangles_;
    std::vector<std::array<std::uint32_t, 3>> vertex_ids_;  ///< of Embree's own triangles
    std::int32_t first_triangle_;
    double build_seconds_ = 0;
    std::atomic<std::ptrdiff_t> bytes_ = 0;  // the device counts in it to its end
    Owned<RTCDevice, rtcReleaseDevice> device_;
    Owned<RTCScene, rtcReleaseScene> scene_;
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
    Mask<Packet> is_hidden = hidden_by_any<features>(scene.large_spheres, query.rays, kLanes<Packet>, light, work);
    if constexpr (features.planar)
        is_hidden = is_hidden || hidden_by_any<features>(scene.planes, query.rays, kLanes<Packet>, light, work);
    return is_hidden ||
           embree.occluded<Packet>(query, select(is_active && !is_hidden, Int<Packet>(-1), Int<Packet>(0)));
}

/// The closest hits of the rays in `is_active`; those of the others mean nothing. Only of camera rays it pays to say
/// that they are coherent.
template <Features features>
RAYPOOL_INLINE Hit<Packet> closest_hits(const EmbreeScene& embree, const SceneView<float>& scene,
                                        const Ray<Packet>& ray, const Int<Packet>& leaving_id,
                                        const Mask<Packet>& is_active,
                                        RTCIntersectContextFlags flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT) {
    Query<Packet> query{{}, {ray, ray_inverse<Packet>(ray.direction), leaving_id}, {}, flags};
    Hit<Packet> hit;
    NoTestCount work;
    intersect_all<features>(scene.large_spheres, query.rays, kLanes<Packet>, hit, work);
    if constexpr (features.planar) intersect_all<features>(scene.planes, query.rays, kLanes<Packet>, hit, work);
    return embree.closest<Packet>(query, hit, select(is_active, Int<Packet>(-1), Int<Packet>(0)));
}

}  // namespace raypool::peers
