/// Embree's structures and calls by the number of rays, and how kernels read and write its fields.
#pragma once

#include <embree3/rtcore.h>

#include <bit>
#include <cstring>

#include "core/math/real.h"
#include "core/math/real_wide.h"

namespace raypool::peers {

/// A packet: as many rays as fill a register, 16 with AVX-512, 8 with AVX2, 4 on ARM.
using Packet = stdx::native_simd<float>;

/// What Embree has for so many rays at a time: its structures, and its calls.
template <int lanes>
struct EmbreeCalls;
template <>
struct EmbreeCalls<1> {
    using RayHit = RTCRayHit;
    using ShadowRay = RTCRay;
    static void trace(const int*, RTCScene scene, RTCIntersectContext* context, RayHit* ray) {
        rtcIntersect1(scene, context, ray);
    }
    static void trace(const int*, RTCScene scene, RTCIntersectContext* context, ShadowRay* ray) {
        rtcOccluded1(scene, context, ray);
    }
};
/// Those of packets, which `valid` masks: -1 for a ray to trace, else 0.
template <class Hits, class Rays, auto intersect, auto occlude>
struct EmbreePacketCalls {
    using RayHit = Hits;
    using ShadowRay = Rays;
    static void trace(const int* valid, RTCScene scene, RTCIntersectContext* context, Hits* rays) {
        intersect(valid, scene, context, rays);
    }
    static void trace(const int* valid, RTCScene scene, RTCIntersectContext* context, Rays* rays) {
        occlude(valid, scene, context, rays);
    }
};
template <>
struct EmbreeCalls<4> : EmbreePacketCalls<RTCRayHit4, RTCRay4, rtcIntersect4, rtcOccluded4> {};
template <>
struct EmbreeCalls<8> : EmbreePacketCalls<RTCRayHit8, RTCRay8, rtcIntersect8, rtcOccluded8> {};
template <>
struct EmbreeCalls<16> : EmbreePacketCalls<RTCRayHit16, RTCRay16, rtcIntersect16, rtcOccluded16> {};

/// Embree's rays and their hits, of a float or a Packet. Of a hit, primID and geomID are used: that of Embree's own
/// triangles with the number of one, or else none with the id of a primitive.
template <class Real>
using RayHit = typename EmbreeCalls<kLanes<Real>>::RayHit;
/// Its rays toward lights.
template <class Real>
using ShadowRay = typename EmbreeCalls<kLanes<Real>>::ShadowRay;

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

}  // namespace raypool::peers
