/// What engines with a pool add to the report of a render: their rounds, lists of rays, and the size of a record.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/runtime/report.h"

namespace raypool::wavefront {

/// The stages of a round. Append is the traffic of records from round to round: what survivors
/// and split records take to reach their places.
enum class Stage : std::uint8_t { Generate, Intersect, Sort, Shade, Shadow, Accumulate, Append };
inline constexpr std::size_t kStageCount = 7;
inline constexpr std::array<const char*, kStageCount> kStageNames{"generate", "intersect",  "sort",  "shade",
                                                                  "shadow",   "accumulate", "append"};

/// One round: all threads, or, of per-thread pools, the rounds of that number added up.
struct RoundReport {
    std::int64_t records_in = 0;                ///< advanced by one bounce
    std::int64_t records_out = 0;               ///< of these, alive afterwards
    std::int64_t lanes = 0;                     ///< used for them: records_in / lanes is the occupancy of the registers
    std::int64_t shadow_rays = 0;               ///< traced by the shadow stage
    std::int64_t shadow_hits = 0;               ///< of these, that met something before their light
    std::int64_t shadow_lanes = 0;              ///< used for them, as lanes
    std::array<double, kStageCount> stage_s{};  ///< added over threads
    double wait_s = 0;                          ///< at barriers, added over threads

    void add(const RoundReport& other) {
        records_in += other.records_in;
        records_out += other.records_out;
        lanes += other.lanes;
        shadow_rays += other.shadow_rays;
        shadow_hits += other.shadow_hits;
        shadow_lanes += other.shadow_lanes;
        for (std::size_t i = 0; i < kStageCount; ++i) stage_s[i] += other.stage_s[i];
        wait_s += other.wait_s;
    }
};

/// The lists of rays that streams took to the nodes and leaves of one level of its trees.
struct ListLevel {
    std::int64_t lists = 0;
    std::int64_t rays = 0;         ///< in all of them; a ray is in as many as it entered nodes and leaves
    std::int64_t single_rays = 0;  ///< of these, in lists so short that their rays went on one by one, out of all lists
    std::int64_t lanes = 0;        ///< of registers, for the others: (rays - single_rays) / lanes is how full they were

    void add(const ListLevel& other) {
        lists += other.lists;
        rays += other.rays;
        single_rays += other.single_rays;
        lanes += other.lanes;
    }
};

struct PoolReport final : EngineReport {
    std::vector<RoundReport> rounds;  ///< with log_rounds or a trace
    std::vector<ListLevel> lists;     ///< with count_work: by level, the root first
    std::size_t record_bytes = 0;     ///< moved in and out of the pool by a record
    std::size_t pool_rays = 0;        ///< records that each pool has room for

    [[nodiscard]] std::shared_ptr<EngineReport> copy() const override { return std::make_shared<PoolReport>(*this); }
    void add(const EngineReport& report) override {
        const auto& later = dynamic_cast<const PoolReport&>(report);
        rounds.insert(rounds.end(), later.rounds.begin(), later.rounds.end());
        add_each<ListLevel>(lists, later.lists);
        record_bytes = std::max(record_bytes, later.record_bytes);
        pool_rays = std::max(pool_rays, later.pool_rays);
    }
};

/// Of a render by an engine with a pool; of any other, an empty one.
inline const PoolReport& pool_report(const RenderReport& report) {
    static const PoolReport kNone;
    const auto* const pool = dynamic_cast<const PoolReport*>(report.engine.get());
    return pool == nullptr ? kNone : *pool;
}

}  // namespace raypool::wavefront
