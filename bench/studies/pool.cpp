// How large a pool must be, whose, and refilled when, to beat recursion: the paper's Figure 8 and the axes around it.

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "core/runtime/settings_text.h"
#include "wavefront/ladder.h"
#include "wavefront/pool_report.h"
#include "wavefront/setting_names.h"

namespace raypool::studies {

namespace {

using wavefront::pool_report;
using wavefront::PoolScope;
using wavefront::PoolSettings;
using wavefront::Refill;
using wavefront::RoundReport;
using wavefront::Sort;

constexpr const char* kPaperPool = "the paper's pool";

/// A pool whose capacity is left open: a line of the picture.
struct Line {
    std::string name;
    PoolSettings pool;
};

/// The paper's pool as it stands; then scope by refill, all else equal; then the fastest.
std::vector<Line> lines() {
    std::vector<Line> lines;
    PoolSettings wide = rung_settings("shared-stream", 1);
    lines.push_back({kPaperPool, rung_settings("shared", 1)});
    lines.push_back({"shared, drain", wide});
    wide.refill = Refill::Regenerate;
    lines.push_back({"shared, regenerate", wide});
    lines.push_back({"thread, drain", rung_settings("thread-small", 1)});
    lines.push_back({"thread, regenerate", rung_settings("regenerate", 1)});
    lines.push_back({"thread, regenerate, beam", rung_settings("beam", 1)});
    return lines;
}

/// A batch that leaves each thread at least two of a shared pool, up to the default.
std::int64_t batch_for(std::int64_t capacity, int threads) {
    const std::int64_t share = threads == 1 ? capacity : capacity / (2 * threads);
    return std::clamp<std::int64_t>(share, 16, PoolSettings{}.batch);
}

/// From 64 to a record for every path of the render.
std::vector<std::int64_t> capacities(std::int64_t paths, std::int64_t factor) {
    std::vector<std::int64_t> list;
    for (std::int64_t capacity = 64; capacity < paths; capacity *= factor) list.push_back(capacity);
    list.push_back(paths);
    return list;
}

/// Behind the cells of every render; `axis` says what a row is for.
Cells pool_cells(const std::string& axis, const PoolSettings& pool) {
    return {{"axis", axis},
            {"scope", to_string(pool.scope)},
            {"refill", to_string(pool.refill)},
            {"camera", to_string(pool.camera)},
            {"stage_width", to_string(pool.width)},
            {"sort", to_string(pool.sort)},
            {"capacity", pool.capacity},
            {"batch", pool.batch}};
}

Case pool_case(const std::string& axis, const Line& line, const std::shared_ptr<const StudyScene>& scene,
               const RenderSettings& settings, int repeats) {
    return render_case(fmt::format("{}: {}, {} records, sort {}, batch {}, {} threads", axis, line.name,
                                   line.pool.capacity, to_string(line.pool.sort), line.pool.batch, settings.threads),
                       {pool_engine(line.name, line.pool), scene, settings}, repeats, pool_cells(axis, line.pool));
}

/// A row for each round in which records were advanced. After a round without any, a pool that drains is full again:
/// `depth` counts from there.
std::vector<Cells> round_rows(const Render& render, const PoolSettings& pool) {
    const Measured measured = measure(render);
    std::vector<Cells> rows;
    std::int64_t round = 0;
    std::int64_t depth = 0;
    for (const RoundReport& work : pool_report(measured.report).rounds) {
        depth = work.records_in == 0 ? 0 : depth + 1;
        ++round;
        if (work.records_in == 0) continue;
        rows.push_back(render_cells(render, measured) + pool_cells("rounds", pool) +
                       Cells{{"round", round},
                             {"depth", pool.refill == Refill::Drain ? Value(depth) : Value(nullptr)},
                             {"records_in", work.records_in},
                             {"records_out", work.records_out},
                             {"lanes", work.lanes}});
    }
    return rows;
}

/// The pools that all threads share, but for the paper's own.
std::vector<Line> shared_lines() {
    std::vector<Line> shared = lines();
    std::erase_if(shared,
                  [](const Line& line) { return line.pool.scope != PoolScope::Shared || line.name == kPaperPool; });
    return shared;
}

/// Of a drained and a regenerating pool, over a few fillings.
void add_rounds(std::vector<Case>& cases, const std::shared_ptr<const StudyScene>& scene, RenderSettings settings) {
    constexpr std::int64_t kFillings = 4;
    const std::int64_t pixels = scene->compiled.pixel_count();
    settings.threads = 1;  // so that every run has the same rounds
    settings.log_rounds = true;
    settings.end_sample =
        std::clamp<std::int64_t>(kFillings * PoolSettings::kSharedCapacity / pixels, 1, settings.end_sample);
    for (Line line : shared_lines()) {
        line.pool.capacity =
            std::clamp<std::int64_t>(pixels * settings.end_sample / kFillings, 64, PoolSettings::kSharedCapacity);
        cases.push_back(case_of("rounds: " + line.name, {pool_engine(line.name, line.pool), scene, settings}, 1,
                                [pool = line.pool](const Render& render) { return round_rows(render, pool); }));
    }
}

std::vector<Case> pool_study_cases(const StudyOptions& options) {
    const auto scene = study_scene(options.scene, choose(options, options.width, {200, 400}));
    const Plan plan = plan_of(options, {4, 8}, {5, 7}, core_count());
    RenderSettings settings = plan.settings;
    settings.schedule = parse_schedule("dynamic");
    const std::int64_t paths = scene->compiled.pixel_count() * settings.end_sample;

    std::vector<Case> cases;
    for (const int threads : one_and_all(plan.most_threads)) {
        settings.threads = threads;
        cases.push_back(render_case(fmt::format("recursive, {} threads", threads),
                                    {recursive_engine(), scene, settings}, plan.repeats, Cells{{"axis", "recursion"}}));
        for (Line line : lines()) {
            for (const std::int64_t capacity : capacities(paths, options.is_quick ? 16 : 4)) {
                line.pool.capacity = capacity;
                line.pool.batch = batch_for(capacity, threads);
                cases.push_back(pool_case("capacity", line, scene, settings, plan.repeats));
            }
        }
        for (Line line : lines()) {
            if (line.name == kPaperPool) continue;
            for (const Sort sort : {Sort::None, Sort::Material}) {
                line.pool.sort = sort;
                cases.push_back(pool_case("sort", line, scene, settings, plan.repeats));
            }
        }
    }
    for (Line line : shared_lines()) {
        for (const std::int64_t batch : {256, 1024, 4096, 16384}) {
            line.pool.batch = batch;
            cases.push_back(pool_case("batch", line, scene, settings, plan.repeats));
        }
    }
    add_rounds(cases, scene, settings);
    return cases;
}

}  // namespace

Study pool_study() {
    return {.name = "pool",
            .question =
                "From what capacity on does a pool beat recursion, and what do scope, refill, sorting and "
                "batches matter?",
            .columns = render_columns(
                {{"axis", ColumnType::Text, "what the row is for: recursion, capacity, sort, batch or rounds"},
                 {"scope", ColumnType::Text, "one pool shared by all threads, or one for each thread"},
                 {"refill", ColumnType::Text, "camera rays enter the empty pool (drain), or as soon as there is room"},
                 {"camera", ColumnType::Text, "camera rays enter at once (staged) or after their first bounce (fused)"},
                 {"stage_width", ColumnType::Text, "a ray at a time (scalar) or a register of them (simd)"},
                 {"sort", ColumnType::Text, "order of records before shading"},
                 {"capacity", ColumnType::Count, "records, of each pool"},
                 {"batch", ColumnType::Count, "records that a thread takes at a time from a shared pool"},
                 {"round", ColumnType::Count, "number of the round"},
                 {"depth", ColumnType::Count, "rounds since the pool was filled, of a pool that drains"},
                 {"records_in", ColumnType::Count, "records advanced in the round"},
                 {"records_out", ColumnType::Count, "of these, alive afterwards"},
                 {"lanes", ColumnType::Count, "lanes of registers used for them"}}),
            .cases = pool_study_cases};
}

}  // namespace raypool::studies
