// Sums of a pixel side by side, or in three planes: the paper's Figure 11, in time and in cache misses.

#include <unistd.h>

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "bench/studies/cache_counts.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "core/runtime/settings_text.h"
#include "wavefront/engine.h"
#include "wavefront/setting_names.h"

namespace raypool::studies {

namespace {

using wavefront::Accumulator;
using wavefront::PoolSettings;

/// A pool, and how its accumulator lays out the sums.
struct Variant {
    const char* name;
    const char* layout;
    PoolSettings pool;
};
std::vector<Variant> variants() {
    std::vector<Variant> all;
    const auto add = [&](const char* name, PoolSettings pool, Accumulator planar) {
        all.push_back({name, "interleaved", pool});
        pool.accumulator = planar;
        all.push_back({name, "planar", pool});
    };
    add("a pool for each thread", rung_settings("beam", 1), Accumulator::OwnedPlanarInt64);
    add("the paper's pool, shared", rung_settings("shared-stream", 1), Accumulator::AtomicPlanarInt64);
    return all;
}

/// Behind the cells of every render.
Cells layout_cells(const StudyScene& scene, const RenderSettings& settings, const char* layout, const char* source) {
    return {{"layout", layout},
            {"framebuffer_bytes", 3 * sizeof(std::int64_t) * static_cast<std::size_t>(scene.compiled.pixel_count())},
            {"paths", scene.compiled.pixel_count() * settings.end_sample},
            {"source", source}};
}

/// Arguments of `raypool render`.
std::vector<std::string> render_arguments(const std::string& scene, std::int64_t width, const RenderSettings& settings,
                                          const PoolSettings& pool) {
    std::vector<std::string> arguments{scene,
                                       "--engine=wavefront",
                                       fmt::format("--width={}", width),
                                       fmt::format("--spp={}", settings.end_sample),
                                       fmt::format("--depth={}", settings.depth),
                                       fmt::format("--seed={}", settings.seed),
                                       fmt::format("--threads={}", settings.threads),
                                       fmt::format("--pool-scope={}", to_string(pool.scope)),
                                       fmt::format("--refill={}", to_string(pool.refill)),
                                       fmt::format("--stage-width={}", to_string(pool.width)),
                                       fmt::format("--intersect={}", to_string(pool.intersection)),
                                       fmt::format("--camera={}", to_string(pool.camera)),
                                       fmt::format("--sort={}", to_string(pool.sort)),
                                       fmt::format("--accumulator={}", to_string(pool.accumulator)),
                                       fmt::format("--pool-rays={}", pool.capacity)};
    if (loops_over_image(pool)) {
        arguments.push_back("--schedule=" + to_string(settings.schedule));
        arguments.push_back("--grain=" + to_string(settings.grain));
    } else {
        arguments.push_back(fmt::format("--append={}", to_string(pool.append)));
        arguments.push_back(fmt::format("--pool-batch={}", pool.batch));
    }
    return arguments;
}

/// Rows of counts have no time: counting disturbs it.
Cells count_cells(const Render& render, const Variant& variant, const char* source, const std::string& hash,
                  const char* part, const CacheCounts& counts) {
    return layout_cells(*render.scene, render.settings, variant.layout, source) +
           Cells{{"engine", render.engine.name},
                 {"threads", render.settings.threads},
                 {"width", render.scene->compiled.width},
                 {"hash", hash},
                 {"part", part},
                 {"data_reads", or_null(counts.reads)},
                 {"data_writes", or_null(counts.writes)},
                 {"d1_read_misses", or_null(counts.d1_read_misses)},
                 {"d1_write_misses", or_null(counts.d1_write_misses)},
                 {"ll_read_misses", or_null(counts.ll_read_misses)},
                 {"ll_write_misses", or_null(counts.ll_write_misses)}} +
           loop_cells(render.engine.engine->loops_over_image(), render.settings);
}

std::vector<Cells> hardware_rows(const Render& render, const Variant& variant) {
    std::string hash;
    const auto counts = count_by_hardware([&] { hash = measure(render).hash; });
    return {count_cells(render, variant, "hardware counters", hash, "render", counts.value_or(CacheCounts{}))};
}

std::vector<Cells> cachegrind_rows(const Render& render, const Variant& variant, const std::string& file) {
    const Cachegrind found =
        run_cachegrind(render_arguments(file, render.scene->compiled.width, render.settings, variant.pool));
    return {count_cells(render, variant, "cachegrind", found.hash, "render", found.rendering),
            count_cells(render, variant, "cachegrind", found.hash, "accumulate", found.accumulating)};
}

bool has_hardware_counters() {
    return count_by_hardware([] {}).has_value();
}

std::vector<Case> framebuffer_cases(const StudyOptions& options) {
    constexpr std::int64_t kSmaller = 5;           // times as wide is the large image
    constexpr std::int64_t kSimulatedWidth = 320;  // whose sums are just too large for kSimulatedLl
    const std::int64_t width = choose(options, options.width, {800, 800});
    const Plan plan = plan_of(options, {1, 4}, {5, 9}, core_count());
    const std::int64_t spp = plan.settings.end_sample;
    RenderSettings settings = plan.settings;
    settings.schedule = parse_schedule("dynamic");
    std::vector<Case> cases;
    // make(what it renders in words, variant, render) is a case.
    const auto each_variant = [&](const auto& scene, std::int64_t samples, const auto& make) {
        settings.end_sample = samples;
        for (const Variant& variant : variants())
            cases.push_back(make(fmt::format("{}, {}, width {}", variant.name, variant.layout, scene->compiled.width),
                                 variant, Render{pool_engine(variant.name, variant.pool), scene, settings}));
    };
    // One image smaller than the second-level cache and one larger, with as many paths.
    const auto large = study_scene(options.scene, width);
    const auto small = study_scene(options.scene, std::max<std::int64_t>(width / kSmaller, 1));
    const auto each_size = [&](const auto& make) {
        each_variant(small, spp * kSmaller * kSmaller, make);
        each_variant(large, spp, make);
    };

    for (const int threads : one_and_all(plan.most_threads)) {
        settings.threads = threads;
        each_size([&](const std::string& what, const Variant& variant, const Render& render) {
            return render_case(fmt::format("time: {}, {} spp, {} threads", what, settings.end_sample, threads), render,
                               plan.repeats, layout_cells(*render.scene, settings, variant.layout, "clock"));
        });
    }

    // Misses, of one thread.
    settings.threads = 1;
    if (has_hardware_counters()) {
        each_size([&](const std::string& what, const Variant& variant, const Render& render) {
            return case_of(fmt::format("counters: {}, {} spp", what, settings.end_sample), render, plan.repeats,
                           [variant](const Render& of) { return hardware_rows(of, variant); });
        });
    } else if (cachegrind_command().why.empty()) {
        const auto make = [&](const std::string& what, const Variant& variant, const Render& render) {
            return case_of("cachegrind: " + what, render, 1, [variant, file = options.scene](const Render& of) {
                return cachegrind_rows(of, variant, file);
            });
        };
        const std::int64_t most_width = std::min(width, kSimulatedWidth);
        if (!options.is_quick)
            each_variant(study_scene(options.scene, std::max<std::int64_t>(most_width * 2 / 5, 1)), 2, make);
        each_variant(study_scene(options.scene, most_width), options.is_quick ? 1 : 2, make);
    }
    return cases;
}

nlohmann::json framebuffer_facts() {
    return {{"second_level_cache_bytes", sysconf(_SC_LEVEL2_CACHE_SIZE)},
            {"why_nothing_is_simulated", has_hardware_counters() ? "" : cachegrind_command().why},
            {"simulated_first_level", kSimulatedD1},
            {"simulated_last_level", kSimulatedLl}};
}

}  // namespace

Study framebuffer_study() {
    return {
        .name = "framebuffer",
        .question = "Do a pixel's sums side by side save time or cache misses over three planes?",
        .columns = render_columns(
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
             {"ll_write_misses", ColumnType::Count, "of the last-level cache; cachegrind's is the second level"}}),
        .cases = framebuffer_cases,
        .facts = framebuffer_facts};
}

}  // namespace raypool::studies
