/// A tile of the image, as the peer's two tracers render it.
#pragma once

#include <cstdint>

#include "bench/peers/camera.h"
#include "bench/peers/embree_scene.h"

namespace raypool::peers {

inline constexpr int kTileEdge = 16;

struct Sky {
    V3<float> middle, slope;  ///< radiance is middle + y slope

    template <class F>
    RAYPOOL_PEER_INLINE V3<F> radiance(V3<F> direction) const {
        return all_lanes<F>(middle) + direction.y * all_lanes<F>(slope);
    }
};

struct Tile {
    const EmbreeScene& scene;
    const PeerCamera& camera;
    Sky sky;
    int x, y;           ///< its first pixel
    int width, height;  ///< in pixels, at most kTileEdge
    std::int64_t spp;
    std::int32_t depth;  ///< > 0
    std::uint64_t seed;
    std::uint64_t first_stream;  ///< of kPacket streams of random numbers that are this tile's
    double* sums;                ///< r, g, b a pixel, row by row; zero at first
};

/// Both return the number of segments traced.
std::int64_t trace_single(const Tile& tile);
std::int64_t trace_packets(const Tile& tile);

}  // namespace raypool::peers
