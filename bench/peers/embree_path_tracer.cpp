#include "bench/peers/embree_path_tracer.h"

#include <pmmintrin.h>

#include <algorithm>
#include <chrono>

#include "bench/peers/tile.h"

namespace raypool::peers {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Denormal numbers count as zero in this thread, as Embree's manual recommends.
class NoDenormals {
  public:
    NoDenormals() : before_(_mm_getcsr()) {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    }
    ~NoDenormals() { _mm_setcsr(before_); }
    NoDenormals(const NoDenormals&) = delete;
    NoDenormals& operator=(const NoDenormals&) = delete;

  private:
    unsigned before_;
};

void copy_means(const Tile& tile, Image& image) {
    const double* sum = tile.sums;
    for (int y = 0; y < tile.height; ++y) {
        float* pixel = image.pixel(tile.x, tile.y + y);
        for (int i = 0; i < 3 * tile.width; ++i) *pixel++ = static_cast<float>(*sum++ / static_cast<double>(tile.spp));
    }
}

}  // namespace

int packet_width() {
    return kPacket;
}

PeerReport render_embree(const Scene& scene, const PeerSettings& settings, Image& image) {
    PeerReport report;
    image = Image(scene.width, scene.height);
    report.paths = scene.width * scene.height * settings.spp;
    if (settings.depth <= 0) return report;

    auto start = std::chrono::steady_clock::now();
    const EmbreeScene embree(scene);
    report.build_s = seconds_since(start);

    const PeerCamera camera(scene);
    const Sky sky{to_v3(0.5 * (scene.background.bottom + scene.background.top)),
                  to_v3(0.5 * (scene.background.top - scene.background.bottom))};
    const std::int64_t across = (scene.width + kTileEdge - 1) / kTileEdge;
    const std::int64_t down = (scene.height + kTileEdge - 1) / kTileEdge;
    const auto trace = settings.mode == PeerMode::Single ? trace_single : trace_packets;

    start = std::chrono::steady_clock::now();
    std::int64_t segments = 0;
#pragma omp parallel num_threads(settings.threads) reduction(+ : segments)
    {
        const NoDenormals guard;
#pragma omp for schedule(dynamic)
        for (std::int64_t i = 0; i < across * down; ++i) {
            double sums[3 * kTileEdge * kTileEdge]{};
            const std::int64_t x = i % across * kTileEdge;
            const std::int64_t y = i / across * kTileEdge;
            const Tile tile{.scene = embree,
                            .camera = camera,
                            .sky = sky,
                            .x = static_cast<int>(x),
                            .y = static_cast<int>(y),
                            .width = static_cast<int>(std::min<std::int64_t>(kTileEdge, scene.width - x)),
                            .height = static_cast<int>(std::min<std::int64_t>(kTileEdge, scene.height - y)),
                            .spp = settings.spp,
                            .depth = settings.depth,
                            .seed = settings.seed,
                            .first_stream = static_cast<std::uint64_t>(i) * kPacket,
                            .sums = sums};
            segments += trace(tile);
            copy_means(tile, image);
        }
    }
    report.seconds = seconds_since(start);
    report.segments = segments;
    return report;
}

}  // namespace raypool::peers
