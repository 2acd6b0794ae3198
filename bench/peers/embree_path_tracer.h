/// The peer: the path tracer that a user would write over Embree 3, for the same scenes.
///
/// Called by `raypool compare`, by raypool_peer_embree and by tests. It is what the engines are measured against, so it
/// is written to be fast; and it shares with them nothing but the scene's description, so that its image, which must
/// agree with theirs within noise, is a check of both. Its random numbers are its own: two renders with different seeds
/// are independent, and a render is repeatable for a mode, whatever the number of threads.
#pragma once

#include <cstdint>

#include "core/image/image.h"
#include "core/scene/scene.h"

namespace raypool::peers {

enum class PeerMode : std::uint8_t {
    Single,  ///< a path at a time, rtcIntersect1
    Packet,  ///< packet_width() paths at a time; a path that ends makes room for the next camera ray
};

/// 16 (rtcIntersect16) where this was compiled for AVX-512, else 8 (rtcIntersect8).
int packet_width();

struct PeerSettings {
    std::int64_t spp = 1;
    std::int32_t depth = 50;  ///< most segments of a path
    std::uint64_t seed = 0;
    int threads = 1;
    PeerMode mode = PeerMode::Packet;
};

struct PeerReport {
    double build_s = 0;  ///< making Embree's tree, in one thread
    double seconds = 0;  ///< wall clock of the parallel region
    std::int64_t paths = 0;
    std::int64_t segments = 0;
};

/// Renders the scene at its size, as linear radiance. Throws std::runtime_error where Embree fails.
PeerReport render_embree(const Scene& scene, const PeerSettings& settings, Image& image);

}  // namespace raypool::peers
