#include "bench/peers/embree_scene.h"

#include <stdexcept>

#include <Eigen/Geometry>

#include "bench/peers/shape_tests.h"

namespace raypool::peers {

namespace {

V3 to_v3(const Vector3d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// What Embree calls. The tables are given as the geometries' user pointers.

/// Widens by a little, so that no hit is lost to the rounding of the box test.
void set_bounds(RTCBounds& out, const Vector3d& low, const Vector3d& high) {
    const double reach = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    const Vector3d pad = Vector3d::Constant(1e-6 * reach);
    const V3 lower = to_v3(low - pad);
    const V3 upper = to_v3(high + pad);
    out = {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, 0};
}

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
    const SphereShape& sphere = static_cast<const SphereShape*>(args->geometryUserPtr)[args->primID];
    const Vector3d first(sphere.center.x, sphere.center.y, sphere.center.z);
    const Vector3d last = first + Vector3d(sphere.motion.x, sphere.motion.y, sphere.motion.z);
    set_bounds(*args->bounds_o, first.cwiseMin(last).array() - sphere.radius,
               first.cwiseMax(last).array() + sphere.radius);
}

void quad_bounds(const RTCBoundsFunctionArguments* args) {
    const Quad& quad = static_cast<const Scene*>(args->geometryUserPtr)->quads[args->primID];
    Vector3d low = quad.corner;
    Vector3d high = quad.corner;
    for (const Vector3d& edge : {quad.edge_u, quad.edge_v, Vector3d(quad.edge_u + quad.edge_v)}) {
        low = low.cwiseMin(quad.corner + edge);
        high = high.cwiseMax(quad.corner + edge);
    }
    set_bounds(*args->bounds_o, low, high);
}

void intersect_sphere(const RTCIntersectFunctionNArguments* args) {
    const SphereShape sphere = static_cast<const SphereShape*>(args->geometryUserPtr)[args->primID];
    if (args->N == 1) {
        if (args->valid[0] != 0) test_sphere(sphere, args->primID, *reinterpret_cast<RTCRayHit*>(args->rayhit));
    } else {
        test_sphere(sphere, args->primID, args->valid, *reinterpret_cast<RTCRayHit16*>(args->rayhit));
    }
}

/// The table of a geometry of quads.
struct QuadTable {
    const FlatShape* shapes;
    std::uint32_t first_id;
};
}  // namespace
}  // namespace raypool::peers
