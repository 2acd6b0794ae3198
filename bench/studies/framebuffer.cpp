// Sums of a pixel side by side, or in three planes: the paper's Figure 11, in time and in cache misses.

#include <unistd.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "bench/studies/cache_counts.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "core/settings_text.h"
#include "wavefront/engine.h"
#include "wavefront/setting_names.h"

namespace raypool::studies {

namespace {

using wavefront::Accumulator;
using wavefront::PoolSettings;

constexpr const char* kInterleaved = "interleaved";
constexpr const char* kPlanar = "planar";
constexpr const char* kThread = "a pool for each thread";
constexpr const char* kShared = "the paper's pool, shared";

/// A pool whose accumulator has both layouts.
struct Pair {
    const char* name;
    PoolSettings pool;
    Accumulator planar;
};
std::vector<Pair> pairs() {
    return {{kThread, rung_settings("fused", 1), Accumulator::OwnedPlanarInt64},
            {kShared, rung_settings("shared-stream", 1), Accumulator::AtomicPlanarInt64}};
}
PoolSettings in_layout(const Pair& pair, const char* layout) {
    PoolSettings pool = pair.pool;
    if (layout == std::string_view(kPlanar)) pool.accumulator = pair.planar;
    return pool;
}

Value or_null(const std::optional<std::int64_t>& count) {
    return count ? Value(*count) : Value(nullptr);
}

/// The columns behind those of every render.
Row cells(const StudyScene& scene, const RenderSettings& settings, const char* layout, const char* source,
          const Value& part, const CacheCounts& counts) {
    return {layout,
            3 * sizeof(std::int64_t) * static_cast<std::size_t>(scene.compiled.pixel_count()),
            scene.compiled.pixel_count() * settings.end_sample,
            source,
            part,
            or_null(counts.reads),
            or_null(counts.writes),
            or_null(counts.d1_read_misses),
            or_null(counts.d1_write_misses),
            or_null(counts.ll_read_misses),
            or_null(counts.ll_write_misses)};
}

/// Arguments of `raypool render`.
std::vector<std::string> render_arguments(const std::string& scene, std::int64_t width, const RenderSettings& settings,
                                          const PoolSettings& pool) {
    return {scene,
            "--engine=wavefront",
            fmt::format("--width={}", width),
            fmt::format("--spp={}", settings.end_sample),
            fmt::format("--depth={}", settings.depth),
            fmt::format("--seed={}", settings.seed),
            fmt::format("--threads={}", settings.threads),
            "--schedule=" + to_string(settings.schedule),
            "--grain=" + to_string(settings.grain),
            fmt::format("--pool-scope={}", to_string(pool.scope)),
            fmt::format("--refill={}", to_string(pool.refill)),
            fmt::format("--stage-width={}", to_string(pool.width)),
            fmt::format("--intersect={}", to_string(pool.intersection)),
            fmt::format("--camera={}", to_string(pool.camera)),
            fmt::format("--sort={}", to_string(pool.sort)),
            fmt::format("--append={}", to_string(pool.append)),
            fmt::format("--accumulator={}", to_string(pool.accumulator)),
            fmt::format("--pool-rays={}", pool.capacity),
            fmt::format("--pool-batch={}", pool.batch)};
}

Case time_case(const Pair& pair, const char* layout, const std::shared_ptr<const StudyScene>& scene,
               const RenderSettings& settings, int repeats) {
    const auto engine = std::make_shared<wavefront::WavefrontEngine>(in_layout(pair, layout));
    return render_case(
        fmt::format("time: {}, {}, width {}, {} threads", pair.name, layout, scene->compiled.width, settings.threads),
        {pair.name, engine}, scene, settings, repeats, cells(*scene, settings, layout, "clock", nullptr, {}));
}

/// Rows of counts have no time: counting disturbs it.
Row count_row(const char* engine, const StudyScene& scene, const RenderSettings& settings, const std::string& hash,
              const Row& behind) {
    Row row{engine,
            settings.threads,
            to_string(settings.schedule),
            to_string(settings.grain),
            scene.compiled.width,
            nullptr,
            nullptr,
            nullptr,
            nullptr,
            hash};
    row.insert(row.end(), behind.begin(), behind.end());
    return row;
}

Case hardware_case(const Pair& pair, const char* layout, const std::shared_ptr<const StudyScene>& scene,
                   const RenderSettings& settings, int repeats) {
    const auto run = [pair, layout, scene, settings]() -> std::vector<Row> {
        std::string hash;
        const auto counts = count_by_hardware(
            [&] { hash = measure(wavefront::WavefrontEngine(in_layout(pair, layout)), *scene, settings).hash; });
        return {
            count_row(pair.name, *scene, settings, hash,
                      cells(*scene, settings, layout, "hardware counters", "render", counts.value_or(CacheCounts{})))};
    };
    return {fmt::format("counters: {}, {}, width {}", pair.name, layout, scene->compiled.width),
            image_of(*scene, settings), repeats, run};
}

Case cachegrind_case(const Pair& pair, const char* layout, const std::string& file,
                     const std::shared_ptr<const StudyScene>& scene, const RenderSettings& settings) {
    const auto run = [pair, layout, file, scene, settings]() -> std::vector<Row> {
        const Cachegrind found =
            run_cachegrind(render_arguments(file, scene->compiled.width, settings, in_layout(pair, layout)));
        const auto row = [&](const char* part, const CacheCounts& counts) {
            return count_row(pair.name, *scene, settings, found.hash,
                             cells(*scene, settings, layout, "cachegrind", part, counts));
        };
        return {row("render", found.rendering), row("accumulate", found.accumulating)};
    };
    return {fmt::format("cachegrind: {}, {}, width {}", pair.name, layout, scene->compiled.width),
            image_of(*scene, settings), 1, run};
}

class FramebufferLayout : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "framebuffer"; }
    [[nodiscard]] std::string question() const override {
        return "Do a pixel's sums side by side save time or cache misses over three planes?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        std::vector<Column> columns = render_columns();
        columns.insert(
            columns.end(),
            {{"layout", ColumnType::Text, "interleaved: a pixel's three sums side by side; planar: in three planes"},
             {"framebuffer_bytes", ColumnType::Count, "of all sums, 8 bytes each"},
             {"paths", ColumnType::Count, "samples rendered"},
             {"source", ColumnType::Text, "clock, hardware counters, or cachegrind (a simulation)"},
             {"part", ColumnType::Text, "what was counted: render (the engine), or of that accumulate"},
             {"data_reads", ColumnType::Count, ""},
             {"data_writes", ColumnType::Count, ""},
             {"d1_read_misses", ColumnType::Count, "of the first-level cache"},
             {"d1_write_misses", ColumnType::Count, "of the first-level cache"},
             {"ll_read_misses", ColumnType::Count, "of the last-level cache; cachegrind's is the second level"},
             {"ll_write_misses", ColumnType::Count, "of the last-level cache; cachegrind's is the second level"}});
        return columns;
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        const std::int64_t width = choose(options.width, options.is_quick, 800, 800);
        const std::int64_t spp = choose(options.spp, options.is_quick, 1, 4);
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 5, 9));
        const int most = static_cast<int>(choose(options.threads, false, 0, core_count()));
        RenderSettings settings;
        settings.depth = static_cast<std::int32_t>(choose(options.depth, options.is_quick, 50, 50));
        settings.seed = options.seed;
        settings.schedule = parse_schedule("dynamic");
        const auto each_layout = [&](const auto& scene, std::int64_t samples, const auto& add) {
            settings.end_sample = samples;
            for (const Pair& pair : pairs())
                for (const char* layout : {kInterleaved, kPlanar}) add(pair, layout, scene);
        };

        // Time: one image smaller than the second-level cache and one larger, with as many paths.
        std::vector<Case> cases;
        const auto large = study_scene(options.scene, width);
        const auto small = study_scene(options.scene, std::max<std::int64_t>(width / kSmaller, 1));
        for (const int threads : one_and_all(most)) {
            settings.threads = threads;
            const auto add = [&](const Pair& pair, const char* layout, const auto& scene) {
                cases.push_back(time_case(pair, layout, scene, settings, repeats));
            };
            each_layout(small, spp * kSmaller * kSmaller, add);
            each_layout(large, spp, add);
        }

        // Misses, of one thread.
        settings.threads = 1;
        if (has_hardware_counters()) {
            const auto add = [&](const Pair& pair, const char* layout, const auto& scene) {
                cases.push_back(hardware_case(pair, layout, scene, settings, repeats));
            };
            each_layout(small, spp * kSmaller * kSmaller, add);
            each_layout(large, spp, add);
        } else if (cachegrind_command().why.empty()) {
            const auto add = [&](const Pair& pair, const char* layout, const auto& scene) {
                cases.push_back(cachegrind_case(pair, layout, options.scene, scene, settings));
            };
            const std::int64_t most_width = std::min(width, kSimulatedWidth);
            if (!options.is_quick)
                each_layout(study_scene(options.scene, std::max<std::int64_t>(most_width * 2 / 5, 1)), 2, add);
            each_layout(study_scene(options.scene, most_width), options.is_quick ? 1 : 2, add);
        }
        return cases;
    }

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions&) const override {
        Summary summary;
        const Table clock = data.where("source", "clock");
        std::vector<double> gains;  // of interleaving, of the shared pool with all threads
        summary.tables.push_back(times(clock, gains));
        const Table counted = misses_of(data);
        if (!counted.is_empty()) summary.tables.push_back(misses(counted));
        summary.findings.push_back(about_misses(counted));
        summary.findings.push_back(about_time(spread(gains), clock.distinct("threads").back().get<int>()));
        summary.pictures.push_back(
            {"framebuffer", "Three sums side by side, or three planes",
             "Left: time of a thread for each sample, median with lowest and highest run, taken in turns. Right: cache "
             "misses of one thread. What to see: bars of a pair are of one length, so the layout does not matter: "
             "samples "
             "of a pixel end close together in time, and what the pools read and write are records, not pixels."});
        add_notes(summary, counted);
        return summary;
    }

  private:
    static constexpr std::int64_t kSmaller = 5;           ///< times as wide is the large image
    static constexpr std::int64_t kSimulatedWidth = 320;  ///< whose sums are just too large for kSimulatedLl

    static bool has_hardware_counters() {
        return count_by_hardware([] {}).has_value();
    }

    /// The rows with counts of the whole render, from whichever source there is.
    static Table misses_of(const Table& data) {
        const Table hardware = data.where("source", "hardware counters");
        return hardware.is_empty() ? data.where("source", "cachegrind") : hardware;
    }

    static TextTable times(const Table& clock, std::vector<double>& gains) {
        TextTable table{
            "Time",
            {"pool", "width", "framebuffer", "threads", "interleaved, s", "planar, s", "planar over interleaved"},
            {}};
        const Value most = clock.distinct("threads").back();
        for (const Value& engine : clock.distinct("engine"))
            for (const Value& width : clock.distinct("width"))
                for (const Value& threads : clock.distinct("threads")) {
                    const Table here = clock.where("engine", engine).where("width", width).where("threads", threads);
                    const std::vector<double> interleaved = here.where("layout", kInterleaved).numbers("seconds");
                    const std::vector<double> planar = here.where("layout", kPlanar).numbers("seconds");
                    const std::vector<double> gain = ratios(planar, interleaved);
                    if (engine == kShared && threads == most) gains.insert(gains.end(), gain.begin(), gain.end());
                    table.rows.push_back({engine.get<std::string>(), width.dump(), size_text(here), threads.dump(),
                                          to_text(spread(interleaved), 3), to_text(spread(planar), 3),
                                          to_text(spread(gain))});
                }
        return table;
    }
    static std::string size_text(const Table& rows) {
        return fmt::format("{:.0f} KiB", rows.numbers("framebuffer_bytes").front() / 1024);
    }

    /// Of accesses to data, in percent: misses of the first-level cache.
    static double miss_rate(const Table& rows) {
        const auto sum = [&](const char* column) {
            const std::vector<double> values = rows.numbers(column);
            return values.empty() ? 0 : median(values);
        };
        const bool has_writes = !rows.numbers("d1_write_misses").empty();  // which not every processor counts
        const double accesses = sum("data_reads") + (has_writes ? sum("data_writes") : 0);
        return accesses == 0 ? 0 : 100 * (sum("d1_read_misses") + sum("d1_write_misses")) / accesses;
    }
    static std::string per_sample(const Table& rows, const char* column) {
        const std::vector<double> values = rows.numbers(column);
        return values.empty() ? "" : fmt::format("{:.3f}", median(values) / rows.numbers("paths").front());
    }

    static TextTable misses(const Table& counted) {
        TextTable table{
            fmt::format("Cache misses of one thread, by {}", counted.distinct("source").front().get<std::string>()),
            {"pool", "part", "width", "framebuffer", "layout", "first-level misses",
             "first-level write misses, a sample", "last-level read misses, a sample",
             "last-level write misses, a sample"},
            {}};
        for (const Value& engine : counted.distinct("engine"))
            for (const Value& part : counted.distinct("part"))
                for (const Value& width : counted.distinct("width"))
                    for (const Value& layout : counted.distinct("layout")) {
                        const Table rows = counted.where("engine", engine)
                                               .where("part", part)
                                               .where("width", width)
                                               .where("layout", layout);
                        if (rows.is_empty()) continue;
                        table.rows.push_back({engine.get<std::string>(), part.get<std::string>(), width.dump(),
                                              size_text(rows), layout.get<std::string>(),
                                              fmt::format("{:.2f} %", miss_rate(rows)),
                                              per_sample(rows, "d1_write_misses"), per_sample(rows, "ll_read_misses"),
                                              per_sample(rows, "ll_write_misses")});
                    }
        return table;
    }

    /// The paper's claim, held against the shared pool and the larger image.
    static Finding about_misses(const Table& counted) {
        constexpr double kLeastGain = 0.95;  // the paper's is 8/11; a twentieth less is not what it speaks of
        Finding finding{"Figure 11",         "an interleaved framebuffer has fewer cache misses than three planes",
                        "11 % to 8 %",       "",
                        Verdict::CannotTell, ""};
        if (counted.is_empty()) {
            finding.why = "no hardware counters, and " + cachegrind_command().why;
            return finding;
        }
        const std::vector<double> widths = counted.numbers("width");
        const Table rows =
            counted.where("engine", kShared)
                .where("part", "render")
                .where("width", static_cast<std::int64_t>(*std::max_element(widths.begin(), widths.end())));
        const double planar = miss_rate(rows.where("layout", kPlanar));
        const double interleaved = miss_rate(rows.where("layout", kInterleaved));
        finding.ours = fmt::format("{:.2f} % to {:.2f} % of accesses to data, first-level cache, by {}", planar,
                                   interleaved, counted.distinct("source").front().get<std::string>());
        finding.verdict = interleaved < kLeastGain * planar ? Verdict::Holds : Verdict::DoesNotHold;
        if (finding.verdict == Verdict::DoesNotHold) finding.why = "the difference is below a twentieth";
        return finding;
    }

    static Finding about_time(const Spread& gain, int threads) {
        constexpr double kNothing = 1.02;
        const bool is_gain = gain.low > 1 && gain.median >= kNothing;
        return {"Figure 11",
                "an interleaved framebuffer is no gain in time",
                "none",
                fmt::format("planes take {} times as long, the paper's pool, {} thread{}", to_text(gain, 3), threads,
                            threads == 1 ? "" : "s"),
                is_gain ? Verdict::DoesNotHold : Verdict::Holds,
                is_gain ? "" : "no gain that stands out of the spread of the runs"};
    }

    static void add_notes(Summary& summary, const Table& counted) {
        const long second_level = sysconf(_SC_LEVEL2_CACHE_SIZE);
        if (second_level > 0)
            summary.notes.push_back(fmt::format("Second-level cache here: {} KiB.", second_level / 1024));
        summary.notes.push_back(
            "Time: the seconds of the parallel region; putting planes together at the end of a render is not in them.");
        if (counted.is_empty()) return;
        if (counted.distinct("source").front() == "cachegrind")
            summary.notes.push_back(fmt::format(
                "Misses: no hardware counters here, so cachegrind, which simulates caches (size, ways, line: {} and "
                "{}) "
                "and counts the same every time; `render` is what the engine does, without putting planes together; "
                "`accumulate` is what of that adds to the framebuffer.",
                kSimulatedD1, kSimulatedLl));
    }
};

}  // namespace

std::unique_ptr<Study> framebuffer_study() {
    return std::make_unique<FramebufferLayout>();
}

}  // namespace raypool::studies
