/// Renders of small scenes by pools of all kinds, for tests of what the pool reports and takes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/small_render.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

namespace raypool::wavefront {

inline RenderSettings settings_of(std::int64_t spp, std::int32_t depth, int threads = 1) {
    RenderSettings settings;
    settings.end_sample = spp;
    settings.depth = depth;
    settings.threads = threads;
    settings.count_work = settings.log_rounds = true;
    return settings;
}

/// The paper's pool as it is on the ladder.
inline PoolSettings shared_pool(std::int64_t capacity = PoolSettings::kSharedCapacity) {
    PoolSettings pool = ladder(1)[0].pool;
    pool.capacity = capacity;
    return pool;
}

template <class Scalar>
Rendered render_pool(const CompiledScene<Scalar>& scene, const RenderSettings& settings, const PoolSettings& pool) {
    return render(WavefrontEngine(pool), scene, settings);
}
inline Rendered render_recursive(const CompiledScene<float>& scene, const RenderSettings& settings) {
    return render(recursive::IterativeEngine(), scene, settings);
}

inline std::int64_t sum(const RenderReport& report, std::int64_t RoundReport::*figure) {
    std::int64_t total = 0;
    for (const RoundReport& round : pool_report(report).rounds) total += round.*figure;
    return total;
}

/// A rung at a capacity that makes many rounds of a small image.
struct Variant {
    std::string name;
    PoolSettings pool;
};
inline std::vector<Variant> variants() {
    std::vector<Variant> all;
    for (const Rung& rung : ladder(2)) {
        for (const std::int64_t capacity : {17, 300, 8192}) {
            Variant variant{fmt::format("{} of {}", rung.name, capacity), rung.pool};
            variant.pool.capacity = capacity;
            variant.pool.batch = 64;
            all.push_back(variant);
        }
    }
    for (const Append append : {Append::InPlace, Append::Atomic, Append::PrefixSum}) {
        Variant variant{fmt::format("shared with append {}", static_cast<int>(append)), {}};
        variant.pool.scope = PoolScope::Shared;
        variant.pool.accumulator = Accumulator::PrivateInt64;
        variant.pool.append = append;
        variant.pool.capacity = 300;
        variant.pool.batch = 50;
        all.push_back(variant);
    }
    return all;
}

}  // namespace raypool::wavefront
