// What a feature costs a scene that does not use it, compiled in against left out: law 3 as a measurement.

#include <utility>

#include <fmt/format.h>

#include "bench/studies/feature_engines.h"
#include "bench/studies/plain_scene.h"
#include "bench/studies/registry.h"
#include "core/base/error.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

constexpr const char* kNothing = "nothing";
constexpr const char* kItsOwn = "its own";
constexpr const char* kAll = "everything";
constexpr const char* kPlain = "plain";

/// One of the functions of feature_engines.h as an engine.
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

const FeatureFunctions& functions_of(std::size_t set) {
    static const std::vector<FeatureFunctions> kParts[] = {functions_of_part<0>(), functions_of_part<1>(),
                                                           functions_of_part<2>()};
    return kParts[set / kPartSets][set % kPartSets];
}

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

std::vector<Case> features_cases(const StudyOptions& options) {
    Scene scene = load_scene(options.scene);
    set_width(scene, choose(options, options.width, {160, 400}));
    const Twins plain = twins(plain_scene(scene));
    const Twins own = twins(scene);
    Plan plan = plan_of(options, {40, 24}, {7, 11}, 1);
    plan.settings.threads = plan.most_threads;

    std::vector<Case> cases;
    const auto add = [&](const NamedEngine& engine, const std::string& scene_name, const char* compiled,
                         const std::shared_ptr<const StudyScene>& study_scene, const Features& features) {
        Cells extra{{"scene", scene_name}, {"compiled", compiled}};
        if (engine.name != iterative_engine().name) {
            extra.emplace_back("record_bytes", ray_record_bytes(features, sizeof(float)));
            extra.emplace_back("record_bytes_double", ray_record_bytes(features, sizeof(double)));
        }
        cases.push_back(render_case(fmt::format("{}, {}, compiled for {}", engine.name, scene_name, compiled),
                                    {engine, study_scene, plan.settings}, plan.repeats, extra));
    };
    for (const auto& [engine, render] :
         {std::pair{iterative_engine(), &iterative_begin}, std::pair{fused_pool(), &pool_begin}}) {
        add(engine, kPlain, kNothing, plain.own, {});
        for (std::size_t i = 0; i < kFeatureSets.size(); ++i)
            add({engine.name, std::make_shared<FeatureEngine>(render(i))}, kPlain, kFeatureSets[i].name, plain.own,
                kFeatureSets[i].features);
        add(engine, kPlain, kAll, plain.everything, kEverything);
        add(engine, own.own->name, kItsOwn, own.own,
            kCompiledFeatures[compiled_features_index(own.own->compiled.features)]);
        add(engine, own.own->name, kAll, own.everything, kEverything);
    }
    return cases;
}

}  // namespace

BeginFunction iterative_begin(std::size_t set) {
    return functions_of(set).iterative;
}
BeginFunction pool_begin(std::size_t set) {
    return functions_of(set).pool;
}

Scene plain_scene(const Scene& scene) {
    if (scene.spheres.empty())
        throw InputError(fmt::format("--scene: {} has no spheres, which is what a plain scene is made of", scene.name));
    Scene plain = scene;
    plain.name += ", plain";
    plain.quads.clear();
    plain.planes.clear();
    plain.camera.defocus_angle_degrees = 0;
    if (plain.background.image) plain.background = {Vector3d::Ones(), Vector3d::Ones()};
    for (Sphere& sphere : plain.spheres) sphere.center1 = sphere.center0;

    const auto grey = static_cast<std::int32_t>(plain.textures.size());
    plain.textures.emplace_back().even = Vector3d::Constant(0.7);
    for (Texture& texture : plain.textures) {
        if (texture.kind == Texture::Kind::Image) texture.even = Vector3d::Constant(0.7);
        texture.kind = Texture::Kind::Solid;
    }
    for (Material& material : plain.materials) {
        const bool has_albedo = material.kind == Material::Kind::Diffuse || material.kind == Material::Kind::Metal;
        material = {Material::Kind::Diffuse, has_albedo ? material.texture_id : grey};
    }
    return plain;
}

Study features_study() {
    return {.name = "features",
            .question = "What does a feature cost, in time and in bytes per ray, where a scene does not use it?",
            .columns =
                render_columns({{"scene", ColumnType::Text, "plain: uses no feature; or the scene as it is"},
                                {"compiled", ColumnType::Text, "the features that the kernels were compiled for"},
                                {"record_bytes", ColumnType::Count, "of a ray record in the pool, single precision"},
                                {"record_bytes_double", ColumnType::Count, "the same in double precision (not run)"}}),
            .cases = features_cases};
}

}  // namespace raypool::studies
