#include "bench/studies/record_traffic.h"

#include <bit>
#include <random>
#include <vector>

#include "bench/studies/statistics.h"
#include "core/base/clock.h"
#include "wavefront/ray_columns.h"

namespace raypool::studies {

namespace {

using wavefront::RayColumns;

/// The survivors of each register of records.
template <class Real>
std::vector<unsigned> survivor_masks(std::size_t registers, double survivors) {
    std::mt19937 random(1);
    std::bernoulli_distribution survives(survivors);
    std::vector<unsigned> masks(registers);
    for (unsigned& mask : masks)
        for (unsigned i = 0; i < kLanes<Real>; ++i) mask |= static_cast<unsigned>(survives(random)) << i;
    return masks;
}

template <Features features, class Real>
double pass_s(std::size_t capacity, double survivors) {
    constexpr int kPasses = 5;
    constexpr std::size_t kRays = kLanes<Real>;
    RayColumns<features, float> records(capacity);
    const std::vector<unsigned> masks = survivor_masks<Real>((capacity + kRays - 1) / kRays, survivors);
    const std::size_t rounds = 1 + 4096 / capacity;  // of a small pool the clock would see nothing
    std::vector<double> seconds;
    for (int pass = 0; pass < kPasses; ++pass) {
        const double begin = wall_seconds();
        for (std::size_t round = 0; round < rounds; ++round) {
            std::size_t kept = 0;
            for (std::size_t i = 0; i < masks.size(); ++i) {
                const RayRecord<Real> record = records.template load<Real>(i * kRays);
                records.template append<Real>(kept, record, masks[i], capacity);
                kept += static_cast<std::size_t>(std::popcount(masks[i]));
            }
            __asm__ volatile("" : : "r"(&records) : "memory");  // what was written may be read
        }
        seconds.push_back((wall_seconds() - begin) / static_cast<double>(rounds * capacity));
    }
    return median(seconds);
}

}  // namespace

double record_pass_s(Features features, wavefront::StageWidth width, std::int64_t capacity, double survivors) {
    using Wide16 = Wide<float, stdx::native_simd<float>::size()>;
    return dispatch_features(features, [&]<Features compiled>() {
        return width == wavefront::StageWidth::Simd
                   ? pass_s<compiled, Wide16>(static_cast<std::size_t>(capacity), survivors)
                   : pass_s<compiled, float>(static_cast<std::size_t>(capacity), survivors);
    });
}

}  // namespace raypool::studies
