// What a feature costs a scene that does not use it, compiled in against left out: law 3 as a measurement.

#include <utility>

#include <fmt/format.h>

#include "bench/studies/feature_engines.h"
#include "bench/studies/plain_scene.h"
#include "bench/studies/studies.h"
#include "core/base/error.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

constexpr const char* kNothing = "nothing";
constexpr const char* kItsOwn = "its own";
constexpr const char* kAll = "everything";
constexpr const char* kPlain = "plain";

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
};

}  // namespace

std::unique_ptr<Study> features_study() {
    return std::make_unique<Needs>();
}

}  // namespace raypool::studies
