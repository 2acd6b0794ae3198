// What a feature costs a scene that does not use it, compiled in against left out: law 3 as a measurement.

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/studies/feature_engines.h"
#include "bench/studies/plain_scene.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "core/base/error.h"
#include "core/scene/scene_reader.h"
#include "core/runtime/settings_text.h"

namespace raypool::studies {

namespace {

constexpr const char* kNothing = "nothing";
constexpr const char* kItsOwn = "its own";
constexpr const char* kAll = "everything";
constexpr const char* kPlain = "plain";
constexpr int kLeastRepeats = 3;  ///< that have a spread worth the name

/// One of the functions of needs_engines.h as an engine.
class FeatureEngine : public Engine {
  public:
    explicit FeatureEngine(BeginFunction function) : function_(function) {}
    [[nodiscard]] std::string name() const override { return "compiled for a feature"; }
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene,
                                                       const RenderSettings& settings,
                                                       Framebuffer& framebuffer) const override {
        return function_(scene, settings, framebuffer);
    }
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>& /*scene*/,
                                                       const RenderSettings& /*settings*/,
                                                       Framebuffer& /*framebuffer*/) const override {
        throw InputError("study features: these kernels are compiled for single precision only");
    }

  private:
    BeginFunction function_;
};

}  // namespace

BeginFunction pool_begin(std::size_t set) {
    if (set < kFileSets) return pool_begin_front(set);
    return set < 2 * kFileSets ? pool_begin_middle(set) : pool_begin_back(set);
}

namespace {

/// The scene as it is, and for the code that can do everything. It is one image.
struct Twins {
    std::shared_ptr<const StudyScene> own, everything;
};
Twins twins(const Scene& scene) {
    StudyScene own{scene.name, compile<float>(scene)};
    StudyScene everything = own;
    everything.compiled.features = kEverything;
    return {std::make_shared<const StudyScene>(std::move(own)),
            std::make_shared<const StudyScene>(std::move(everything))};
}

/// Is what was measured slower than without, beyond what the runs and the place of the code scatter?
bool is_slower(const Spread& ratio, const Spread& control) {
    return ratio.low > 1 && ratio.median > control.high;
}

class Needs : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "features"; }
    [[nodiscard]] std::string question() const override {
        return "What does a feature cost, in time and in bytes per ray, where a scene does not use it?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        std::vector<Column> columns = render_columns();
        columns.push_back({"scene", ColumnType::Text, "plain: uses no feature; or the scene as it is"});
        columns.push_back({"compiled", ColumnType::Text, "the features that the kernels were compiled for"});
        columns.push_back({"record_bytes", ColumnType::Count, "of a ray record in the pool, single precision"});
        columns.push_back({"record_bytes_double", ColumnType::Count, "the same in double precision (not run)"});
        return columns;
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        Scene scene = load_scene(options.scene);
        set_width(scene, choose(options.width, options.is_quick, 160, 400));
        const Twins plain = twins(plain_scene(scene));
        const Twins own = twins(scene);
        RenderSettings settings;
        settings.end_sample = choose(options.spp, options.is_quick, 40, 24);
        settings.depth = static_cast<std::int32_t>(choose(options.depth, options.is_quick, 50, 50));
        settings.seed = options.seed;
        settings.threads = static_cast<int>(choose(options.threads, false, 0, 1));
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 7, 11));

        std::vector<Case> cases;
        const auto add = [&](const NamedEngine& engine, const char* scene_name, const char* compiled,
                             const std::shared_ptr<const StudyScene>& study_scene, const Features& features) {
            const bool has_records = engine.name != iterative_engine().name;
            const auto bytes = [&](std::size_t scalar) {
                return has_records ? Value(ray_record_bytes(features, scalar)) : Value(nullptr);
            };
            cases.push_back(render_case(fmt::format("{}, {}, compiled for {}", engine.name, scene_name, compiled),
                                        engine, study_scene, settings, repeats,
                                        {scene_name, compiled, bytes(sizeof(float)), bytes(sizeof(double))}));
        };
        for (const auto& [engine, render] :
             {std::pair{iterative_engine(), &iterative_begin}, std::pair{fused_pool(), &pool_begin}}) {
            add(engine, kPlain, kNothing, plain.own, {});
            for (std::size_t i = 0; i < kFeatureSets.size(); ++i)
                add({engine.name, std::make_shared<FeatureEngine>(render(i))}, kPlain, kFeatureSets[i].name, plain.own,
                    kFeatureSets[i].features);
            add(engine, kPlain, kAll, plain.everything, kEverything);
            const std::string scene_name = own.own->name;
            add(engine, scene_name.c_str(), kItsOwn, own.own,
                kCompiledFeatures[compiled_features_index(own.own->compiled.features)]);
            add(engine, scene_name.c_str(), kAll, own.everything, kEverything);
        }
        return cases;
    }

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions&) const override {
        Summary summary;
        const std::vector<Value> engines = data.distinct("engine");
        const Value own_scene = data.distinct("scene").back();
        const auto rows = [&](const Value& engine, const Value& scene, const Value& compiled) {
            return data.where("engine", engine).where("scene", scene).where("compiled", compiled);
        };
        const auto ratio = [&](const Value& engine, const Value& scene, const Value& compiled) {
            const Value base = scene == kPlain ? kNothing : kItsOwn;
            return spread(
                ratios(rows(engine, scene, compiled).numbers("seconds"), rows(engine, scene, base).numbers("seconds")));
        };
        const bool has_spread = rows(engines[0], kPlain, kNothing).rows().size() >= kLeastRepeats;

        // Both scenes, every set.
        for (const Value& scene : data.distinct("scene")) {
            TextTable table{
                fmt::format("Scene {}: time by what the kernels were compiled for", scene.get<std::string>()),
                {"compiled for", "bytes of a record", "in double precision"},
                {}};
            for (const Value& engine : engines) {
                table.header.push_back(engine.get<std::string>() + ", M paths/s");
                table.header.push_back(engine.get<std::string>() + ", time over the first row's");
            }
            for (const Value& compiled : data.where("scene", scene).distinct("compiled")) {
                const Table of_pool = rows(engines.back(), scene, compiled);
                std::vector<std::string> row{compiled.get<std::string>(),
                                             fmt::format("{}", of_pool.numbers("record_bytes").at(0)),
                                             fmt::format("{}", of_pool.numbers("record_bytes_double").at(0))};
                for (const Value& engine : engines) {
                    row.push_back(fmt::format("{:.2f}", median(rows(engine, scene, compiled).numbers("mpaths_per_s"))));
                    row.push_back(to_text(ratio(engine, scene, compiled)));
                }
                table.rows.push_back(std::move(row));
            }
            summary.tables.push_back(std::move(table));
        }

        // A finding for each feature, for all of them, and for the scene itself.
        const auto find = [&](const std::string& claim, const Value& scene, const Value& compiled) {
            std::vector<std::string> ours;
            bool is_any_slower = false;
            bool is_all_within = true;
            for (const Value& engine : engines) {
                const Spread time = ratio(engine, scene, compiled);
                const bool is_cost = is_slower(time, ratio(engine, kPlain, kControl));
                is_any_slower |= is_cost;
                is_all_within &= time.median <= ratio(engine, kPlain, kControl).high;
                ours.push_back(fmt::format("{}: {} {}", engine.get<std::string>(),
                                           is_cost ? "slower," : "no difference,", to_text(time)));
            }
            summary.findings.push_back({"", claim, "", fmt::format("{}", fmt::join(ours, "; ")),
                                        !has_spread     ? Verdict::CannotTell
                                        : is_any_slower ? Verdict::Holds
                                        : is_all_within ? Verdict::DoesNotHold
                                                        : Verdict::CannotTell,
                                        !has_spread ? "fewer than three runs have no spread"
                                        : is_any_slower || is_all_within
                                            ? ""
                                            : "slower than the control, not in every run"});
        };
        for (const FeatureName& feature : kFeatureNames)
            find(fmt::format("`{}` costs time where it is compiled in and not used", feature.name), kPlain,
                 feature.name);
        find("all features together cost time where none is used", kPlain, kAll);
        find(fmt::format("what `{}` does not use costs it time", own_scene.get<std::string>()), own_scene, kAll);
        const std::vector<double> bytes = data.where("engine", engines.back()).numbers("record_bytes");
        const auto [least, most] = std::minmax_element(bytes.begin(), bytes.end());
        summary.findings.push_back({"", "a record of single precision holds at most 64 bytes", "",
                                    fmt::format("{} to {} bytes, in single precision", *least, *most),
                                    *most <= 64 ? Verdict::Holds : Verdict::DoesNotHold, ""});

        summary.pictures.push_back(
            {"features", "What an unused feature costs",
             "The plain scene uses no feature. Each mark is the time with one feature compiled in over the time with "
             "none: the median of runs side by side, with their lowest and highest. Grey: the range of the control, "
             "which is the same code at another address. What to see: marks right of the grey band are what leaving "
             "the feature out gains; the bytes of a record change with motion only."});
        summary.notes.emplace_back(
            "A feature is said to be slower where every run was slower than its neighbour without it, and the median "
            "is "
            "beyond every run of the control; `fuzz` comes with the metal that it belongs to. All rows of a scene have "
            "one hash.");
        return summary;
    }
};

}  // namespace

std::unique_ptr<Study> features_study() {
    return std::make_unique<Needs>();
}

}  // namespace raypool::studies
