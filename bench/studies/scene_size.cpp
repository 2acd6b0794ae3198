// From which size of scene on a pool beats recursion, and how large it must be: engine by capacity by shapes by depth.

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/cache_counts.h"
#include "bench/studies/generated_scene.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/sized_render.h"
#include "core/runtime/settings_text.h"
#include "wavefront/capacity.h"
#include "wavefront/pool_report.h"

#ifdef RAYPOOL_HAS_EMBREE
#include "bench/peers/embree_engine.h"
#include "bench/peers/mean_difference.h"
#endif

namespace raypool::studies {

namespace {

using wavefront::PoolSettings;

// Ways that are no number of records.
constexpr const char* kRecursion = "recursion";
constexpr const char* kAutomatic = "automatic";
// Before the name of a way, and a comma, as kCounted.
constexpr const char* kLists = "lists";

/// Meshes without peers: instances they have not, and on needles Embree's own triangles make another image
/// (docs/pool.md).
constexpr const char* kInstances = "instances";
constexpr const char* kNeedles = "needles";
/// What the script scenes/generate strews, and scenes/generate_mesh.
constexpr const char* kStrewnKinds[] = {"spheres", "quads", "cluster"};
constexpr const char* kMeshKinds[] = {"field", "room", "terrain", "blob", kNeedles, kInstances};

using Rows = std::vector<Cells>;

Case sized_case(const std::string& what, const SizedRender& render, int repeats, Rows (*rows)(const SizedRender&)) {
    const SizedScene& scene = *render.scene;
    const RenderSettings& settings = render.settings;
    return {fmt::format("{} {}, depth {}: {}", scene.shapes, scene.kind, settings.depth, what),
            fmt::format("{} {}, {} wide, {} spp, depth {}, seed {}", scene.shapes, scene.kind, scene.width,
                        settings.end_sample, settings.depth, settings.seed),
            repeats, [=] { return rows(render); }};
}

Rows timed_rows(const SizedRender& render) {
    return {render.cells(render.way.name, measure(render.get()))};
}

#ifdef RAYPOOL_HAS_EMBREE
/// Embree with our tests of triangles and with its own. Hits need not be ours to the bit: images are checked by their
/// means.
void add_peers(std::vector<Case>& cases, const std::shared_ptr<SizedScene>& scene, const RenderSettings& settings,
               int repeats) {
    const auto recursion = std::make_shared<Lazy<std::shared_ptr<const Framebuffer>>>([=] {
        return measure({recursive_engine(), scene->get(), settings}).image;
    });
    for (const auto& engine : peers::embree_engines(true)) {
        const SizedRender render{{engine->name(), std::nullopt, engine}, scene, settings};
        Case made = sized_case(fmt::format("{}, {} threads", engine->name(), settings.threads), render, repeats, {});
        made.image.clear();
        made.run = [=]() -> Rows {
            const Measured measured = measure(render.get());
            const peers::MeanDifference off = peers::mean_difference(*measured.image, *(*recursion)());
            if (!off.is_noise())
                throw std::runtime_error(
                    fmt::format("{}, {} triangles: the image of {} is off by {:.1f} standard errors", scene->kind,
                                scene->shapes, engine->name(), off.standard_errors));
            return {render.cells(engine->name(), measured)};
        };
        cases.push_back(std::move(made));
    }
}
#endif

Rows hardware_rows(const SizedRender& render) {
    const Render made = render.get();  // before anything is counted
    Measured measured;
    const auto found = count_by_hardware([&] { measured = measure(made); });
    const CacheCounts counts = found.value_or(CacheCounts{});
    return {render.miss_cells(measured, "hardware counters", or_null(counts.d1_read_misses),
                              or_null(counts.ll_read_misses))};
}

/// Misses of the samples behind the first so many, so that what is done once for a scene is in neither figure. Small
/// images: a simulated cache is a hundred times slower.
Rows cachegrind_rows(const SizedRender& render) {
    const std::optional<PoolSettings>& pool = render.way.pool;
    const GeneratedScene file(render.scene->kind, render.scene->shapes);
    const auto count = [&](std::int64_t spp) {
        std::vector<std::string> arguments{file.path().string(),
                                           fmt::format("--width={}", render.scene->width),
                                           fmt::format("--spp={}", spp),
                                           fmt::format("--depth={}", render.settings.depth),
                                           fmt::format("--seed={}", render.settings.seed),
                                           "--light-sampling=" + to_string(render.settings.light_sampling),
                                           "--threads=1",
                                           pool ? "--engine=wavefront" : "--engine=recursive"};
        if (pool && pool->capacity > 0) arguments.push_back(fmt::format("--pool-rays={}", pool->capacity));
        return run_cachegrind(arguments);
    };
    // Where all fits into a cache, the few misses of two processes differ by chance.
    const auto more = [](const std::optional<std::int64_t>& a, const std::optional<std::int64_t>& b) {
        return std::max<std::int64_t>(*a - *b, 0);
    };
    const Cachegrind first = count(1);
    const Cachegrind all = count(render.settings.end_sample);
    Measured measured = measure(render.get());
    if (measured.hash != all.hash) throw std::runtime_error("the image under cachegrind is another one");
    measured.report.threads.front().segments = all.segments - first.segments;
    return {render.miss_cells(measured, "cachegrind", more(all.all.d1_read_misses, first.all.d1_read_misses),
                              more(all.all.ll_read_misses, first.all.ll_read_misses))};
}

/// The lists of a pool, a row for each level of the trees.
Rows list_rows(const SizedRender& render) {
    SizedRender counted = render;
    counted.settings.count_work = true;
    const Measured measured = measure(counted.get());
    Rows rows;
    for (const wavefront::ListLevel& level : wavefront::pool_report(measured.report).lists) {
        if (level.lists == 0) break;
        rows.push_back(render.cells(fmt::format("{}, {}", kLists, render.way.name), measured) +
                       Cells{{"level", rows.size()},
                             {"lists", level.lists},
                             {"list_rays", level.rays},
                             {"single_rays", level.single_rays},
                             {"lanes", level.lanes}});
    }
    return rows;
}

/// A kind of mesh that is not asked how many records a pool must hold.
bool is_plain_mesh(const std::string& kind) {
    return is_mesh(kind) && kind != kMeshKinds[0];
}
std::vector<std::string> kinds(bool is_quick) {
    std::vector<std::string> all(std::begin(kStrewnKinds), std::end(kStrewnKinds));
    all.insert(all.end(), std::begin(kMeshKinds), is_quick ? std::begin(kMeshKinds) + 1 : std::end(kMeshKinds));
    return all;
}
std::vector<std::int64_t> sizes(const std::string& kind, bool is_quick) {
    if (is_quick) return {100, 1000, 10'000};
    std::vector<std::int64_t> all{1000, 10'000, 100'000};
    if (kind != kNeedles) all.push_back(1'000'000);  // recursion takes minutes for each of so many needles' images
    if (!is_mesh(kind)) all.insert(all.begin(), 100);
    if (is_mesh(kind) && !is_plain_mesh(kind)) all.insert(all.end(), {5'000'000, 10'000'000});
    return all;
}
std::vector<std::int64_t> depths(const std::string& kind, const StudyOptions& options) {
    if (options.depth != 0) return {options.depth};
    if (options.is_quick || is_mesh(kind)) return {50};
    return {1, 50};
}
std::vector<SizedWay> sized_ways(const std::string& kind, std::int64_t shapes, bool is_quick) {
    std::vector<SizedWay> ways{{kRecursion, std::nullopt}, {kAutomatic, PoolSettings{}}};
    if (is_plain_mesh(kind) || shapes > 1'000'000) return ways;
    for (const std::int64_t capacity : {2048, 8192, 32'768, 131'072}) {
        if (is_quick && capacity > 32'768) continue;
        PoolSettings pool;
        pool.capacity = capacity;
        ways.push_back({std::to_string(capacity), pool});
    }
    return ways;
}

std::vector<Case> scene_size_cases(const StudyOptions& options) {
    constexpr std::int64_t kMostSimulated = 100'000;  // shapes
    constexpr std::int64_t kSimulatedWidth = 96;
    constexpr std::int64_t kSimulatedSpp = 5;
    const Plan plan = plan_of(options, {4, 8}, {3, 5}, options.is_quick ? 1 : core_count());
    RenderSettings settings = with_way(plan.settings, {"", "tile:8", "dynamic"});
    const std::int64_t width = choose(options, options.width, {96, 256});
    const bool has_counters = count_by_hardware([] {}).has_value();
    const bool has_cachegrind = !has_counters && !options.is_quick && cachegrind_command().why.empty();

    std::vector<Case> cases;
    for (const std::string& kind : kinds(options.is_quick)) {
        // The rooms around meshes have a lamp, which would hardly be met by chance.
        settings.light_sampling = is_mesh(kind) ? LightSampling::Mis : LightSampling::None;
        for (const std::int64_t shapes : sizes(kind, options.is_quick)) {
            const std::vector<SizedWay> ways = sized_ways(kind, shapes, options.is_quick);
            const auto scene = std::make_shared<SizedScene>(kind, shapes, width);
            for (const std::int64_t depth : depths(kind, options)) {
                settings.depth = static_cast<std::int32_t>(depth);
                for (const int threads : one_and_all(plan.most_threads)) {
                    settings.threads = threads;
                    for (const SizedWay& way : ways)
                        cases.push_back(sized_case(fmt::format("{}, {} threads", way.name, threads),
                                                   {way, scene, settings}, plan.repeats, timed_rows));
                }
                settings.threads = 1;
#ifdef RAYPOOL_HAS_EMBREE
                // Their trees are built for each render, which takes longer than it.
                if (is_mesh(kind) && kind != kInstances && kind != kNeedles && depth == depths(kind, options).back())
                    add_peers(cases, scene, settings, plan.repeats);
#endif
                for (const SizedWay& way : ways) {
                    const SizedRender render{way, scene, settings};
                    if (has_counters)
                        cases.push_back(sized_case("cache misses of " + way.name, render, 1, hardware_rows));
                    // Camera rays go down in beams, and are in no list.
                    if (way.pool && depth > 1)
                        cases.push_back(sized_case("lists of " + way.name, render, 1, list_rows));
                }
            }
            if (!has_cachegrind || shapes > kMostSimulated || is_plain_mesh(kind)) continue;
            const auto small = std::make_shared<SizedScene>(kind, shapes, std::min(width, kSimulatedWidth));
            RenderSettings few = settings;
            few.end_sample = kSimulatedSpp;
            for (const SizedWay& way : {ways[0], ways[1]})
                cases.push_back(sized_case("cache misses of " + way.name, {way, small, few}, 1, cachegrind_rows));
        }
    }
    return cases;
}

}  // namespace

Study scene_size_study() {
    return {.name = "scene-size",
            .question = "At which size of scene does a pool beat recursion, and how many records must it hold?",
            .columns = render_columns(
                {{"kind", ColumnType::Text,
                  "what was made: spheres, quads or a cluster by scenes/generate, a mesh by scenes/generate_mesh"},
                 {"shapes", ColumnType::Count, "how many; of a mesh about as many triangles"},
                 {"depth", ColumnType::Count, "most segments of a path; 1: camera rays alone"},
                 {"way", ColumnType::Text,
                  "recursion, a capacity, automatic, or a peer over Embree; cache misses or lists of one of these"},
                 {"capacity", ColumnType::Count, "records of the pool of each thread"},
                 {"tree_bytes", ColumnType::Count, "nodes and leaves of the scene's trees"},
                 {"segments", ColumnType::Count, "rays traced"},
                 {"ns_per_segment", ColumnType::Real, "nanoseconds of a thread for a segment"},
                 {"source", ColumnType::Text, "of misses: hardware counters, or cachegrind (a simulation)"},
                 {"d1_read_misses", ColumnType::Count, "of the first-level cache, by all segments"},
                 {"ll_read_misses", ColumnType::Count, "of the last-level cache; cachegrind's is the second level"},
                 {"level", ColumnType::Count, "of the trees, the root's is 0"},
                 {"lists", ColumnType::Count, "lists of rays at nodes and leaves of the level"},
                 {"list_rays", ColumnType::Count, "rays in them"},
                 {"single_rays", ColumnType::Count, "of these, in short lists: each went on alone, in no list"},
                 {"lanes", ColumnType::Count, "of registers, for the other rays"}}),
            .cases = scene_size_cases};
}

}  // namespace raypool::studies
