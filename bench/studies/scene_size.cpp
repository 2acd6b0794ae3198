// From which size of scene on a pool beats recursion, and how large it must be: engine by capacity by shapes by depth.

#include <optional>

#include <fmt/format.h>

#include "bench/studies/cache_counts.h"
#include "bench/studies/generated_scene.h"
#include "bench/studies/renders.h"
#include "bench/studies/scene_size_summary.h"
#include "bench/studies/studies.h"
#include "core/scene_reader.h"
#include "core/settings_text.h"
#include "wavefront/capacity.h"
#include "wavefront/engine.h"

namespace raypool::studies {

namespace {

using wavefront::PoolSettings;

/// A generated scene that is made when it is first rendered: a study is planned more often than it is run.
class SizedScene {
  public:
    SizedScene(std::string kind, std::int64_t shapes, std::int64_t width)
        : kind_(std::move(kind)), shapes_(shapes), width_(width) {}
    [[nodiscard]] const std::string& kind() const { return kind_; }
    [[nodiscard]] std::int64_t shapes() const { return shapes_; }
    [[nodiscard]] const StudyScene& get() {
        if (!made_) {
            Scene scene = generated_scene(kind_, shapes_);
            set_width(scene, width_);
            made_.emplace(StudyScene{scene.name, compile<float>(scene)});
        }
        return *made_;
    }
    [[nodiscard]] std::string image(const RenderSettings& settings) const {
        return fmt::format("{} {}, {} wide, {} spp, depth {}, seed {}", shapes_, kind_, width_, settings.end_sample,
                           settings.depth, settings.seed);
    }

  private:
    std::string kind_;
    std::int64_t shapes_;
    std::int64_t width_;
    std::optional<StudyScene> made_;
};

/// An engine, by how large its pools are; recursion has none.
struct SizedWay {
    std::string name;
    std::optional<PoolSettings> pool;
};

NamedEngine sized_engine(const SizedWay& way) {
    if (!way.pool) return recursive_engine();
    return {"pool", std::make_shared<wavefront::WavefrontEngine>(*way.pool)};
}

Row sized_row(const SizedWay& way, SizedScene& scene, const RenderSettings& settings, const Measured& measured,
              const CacheCounts& counts) {
    const NamedEngine engine = sized_engine(way);
    const RenderReport& report = measured.report;
    const auto or_null = [](const std::optional<std::int64_t>& count) {
        return count ? Value(*count) : Value(nullptr);
    };
    Row row = render_row(engine.name, *engine.engine, scene.get(), settings, measured);
    const Row more{scene.kind(),
                   scene.shapes(),
                   settings.depth,
                   way.name,
                   way.pool ? Value(report.pool_rays) : Value(nullptr),
                   wavefront::tree_bytes(scene.get().compiled),
                   report.segments(),
                   1e9 * report.seconds * settings.threads / static_cast<double>(report.segments()),
                   or_null(counts.d1_read_misses),
                   or_null(counts.ll_read_misses)};
    row.insert(row.end(), more.begin(), more.end());
    return row;
}

Case sized_case(const SizedWay& way, const std::shared_ptr<SizedScene>& scene, const RenderSettings& settings,
                int repeats) {
    const auto run = [way, scene, settings]() -> std::vector<Row> {
        const StudyScene& made = scene->get();
        return {sized_row(way, *scene, settings, measure(*sized_engine(way).engine, made, settings), {})};
    };
    return {fmt::format("{} {}, depth {}: {}, {} threads", scene->shapes(), scene->kind(), settings.depth, way.name,
                        settings.threads),
            scene->image(settings), repeats, run};
}

/// Its time is not used: counting takes some.
Case counted_case(SizedWay way, const std::shared_ptr<SizedScene>& scene, const RenderSettings& settings) {
    const std::string id =
        fmt::format("{} {}, depth {}: cache misses of {}", scene->shapes(), scene->kind(), settings.depth, way.name);
    way.name = fmt::format("{}, {}", kCounted, way.name);
    const auto run = [way, scene, settings]() -> std::vector<Row> {
        const StudyScene& made = scene->get();
        Measured measured;
        const auto counts = count_by_hardware([&] { measured = measure(*sized_engine(way).engine, made, settings); });
        return {sized_row(way, *scene, settings, measured, counts.value_or(CacheCounts{}))};
    };
    return {id, scene->image(settings), 1, run};
}

class SceneSize : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "scene-size"; }
    [[nodiscard]] std::string question() const override {
        return "At which size of scene does a pool beat recursion, and how many records must it hold?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        std::vector<Column> columns = render_columns();
        columns.insert(columns.end(),
                       {{"kind", ColumnType::Text, "what scenes/generate strewed: spheres, quads or a cluster"},
                        {"shapes", ColumnType::Count, "how many"},
                        {"depth", ColumnType::Count, "most segments of a path; 1: camera rays alone"},
                        {"way", ColumnType::Text, "recursion, a capacity, automatic, or cache misses of one of these"},
                        {"capacity", ColumnType::Count, "records of the pool of each thread"},
                        {"tree_bytes", ColumnType::Count, "nodes and leaves of the scene's trees"},
                        {"segments", ColumnType::Count, "rays traced"},
                        {"ns_per_segment", ColumnType::Real, "nanoseconds of a thread for a segment"},
                        {"d1_read_misses", ColumnType::Count, "counted by the processor: first-level cache"},
                        {"ll_read_misses", ColumnType::Count, "counted by the processor: last-level cache"}});
        return columns;
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        RenderSettings settings;
        settings.end_sample = choose(options.spp, options.is_quick, 4, 8);
        settings.seed = options.seed;
        settings.schedule = parse_schedule("dynamic");
        settings.grain = parse_grain("tile:8");
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 3, 5));
        const int most = static_cast<int>(choose(options.threads, options.is_quick, 1, core_count()));
        const std::int64_t width = choose(options.width, options.is_quick, 96, 256);
        const std::vector<SizedWay> ways = all_ways(options.is_quick);
        const bool can_count = count_by_hardware([] {}).has_value();

        std::vector<Case> cases;
        for (const char* kind : kSceneKinds) {
            for (const std::int64_t shapes : sizes(options.is_quick)) {
                const auto scene = std::make_shared<SizedScene>(kind, shapes, width);
                for (const std::int64_t depth : depths(options)) {
                    settings.depth = static_cast<std::int32_t>(depth);
                    for (const int threads : one_and_all(most)) {
                        settings.threads = threads;
                        for (const SizedWay& way : ways) cases.push_back(sized_case(way, scene, settings, repeats));
                    }
                    settings.threads = 1;
                    if (!can_count) continue;
                    for (const SizedWay& way : ways) cases.push_back(counted_case(way, scene, settings));
                }
            }
        }
        return cases;
    }

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions&) const override {
        return summarise_scene_size(data);
    }

  private:
    static std::vector<std::int64_t> sizes(bool is_quick) {
        if (is_quick) return {100, 1000, 10'000};
        return {100, 1000, 10'000, 100'000, 1'000'000};
    }
    static std::vector<std::int64_t> depths(const StudyOptions& options) {
        if (options.depth != 0) return {options.depth};
        if (options.is_quick) return {50};
        return {1, 50};
    }
    static std::vector<SizedWay> all_ways(bool is_quick) {
        std::vector<SizedWay> ways{{kRecursion, std::nullopt}, {kAutomatic, PoolSettings{}}};
        for (const std::int64_t capacity : {2048, 8192, 32'768, 131'072}) {
            if (is_quick && capacity > 32'768) continue;
            PoolSettings pool;
            pool.capacity = capacity;
            ways.push_back({std::to_string(capacity), pool});
        }
        return ways;
    }
};

}  // namespace

std::unique_ptr<Study> scene_size_study() {
    return std::make_unique<SceneSize>();
}

}  // namespace raypool::studies
