// Light sampling against chance: what a path costs, how noisy it is, and so how much sooner an image has an error.

#include <memory>

#include <fmt/format.h>

#include "bench/accuracy/reference.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/runner.h"
#include "core/base/error.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

using accuracy::Configuration;
using accuracy::Values;
using SharedScene = std::shared_ptr<const accuracy::SceneInBoth>;

constexpr LightSampling kModes[] = {LightSampling::None, LightSampling::Light, LightSampling::Mis};
/// Of rows: what is varied.
constexpr const char* kScenes = "scene";
constexpr const char* kFloors = "floor of the room";
constexpr const char* kLamps = "edge of the lamp";

/// With lights, with light that is found by chance alone, and without lights.
constexpr const char* kSceneNames[] = {"cornell", "small_lamp", "caustic", "many_lights", "half_sky"};
constexpr double kFuzzes[] = {0, 0.1, 0.5, 1};
/// Over that of the ceiling; 1 is the whole of it.
constexpr double kLampEdges[] = {1, 0.5, 0.15, 0.025};
constexpr double kUsualLampEdge = 0.15;

Material metal(double fuzz) {
    Material material;
    material.kind = Material::Kind::Metal;
    material.fuzz = fuzz;
    return material;
}

/// A room of edge 1, open toward the camera, with a diffuse ball in it. The lamp hangs just below the ceiling, shines
/// downward and has always the same power. The floor is of the given material; its colour is the walls'.
Scene lamp_room(const std::string& name, double lamp_edge, const Material& floor) {
    Scene scene;
    scene.name = name;
    scene.description = "A room with a lamp in its ceiling.";
    scene.width = scene.height = 100;
    scene.camera.look_from = {0.5, 0.5, -1.4};
    scene.camera.look_at = {0.5, 0.42, 0.5};
    scene.camera.vertical_fov_degrees = 40;
    scene.textures.resize(2);
    scene.textures[0].even = Vector3d::Constant(0.7);
    scene.textures[1].even = Vector3d::Constant(0.25 / (lamp_edge * lamp_edge));
    scene.materials = {Material{}, Material{}, floor};
    scene.materials[1].kind = Material::Kind::Emissive;
    scene.materials[1].texture_id = 1;
    scene.materials[1].front_only = true;
    const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), origin(0, 0, 0);
    scene.quads = {{origin, z, x, 2}, {y, x, z, 0}, {origin, y, z, 0}, {x, z, y, 0}, {z, y, x, 0}};
    const double corner = 0.5 - 0.5 * lamp_edge;
    scene.quads.push_back({{corner, 0.999, corner}, lamp_edge * x, lamp_edge * z, 1});
    scene.spheres.push_back({{0.35, 0.2, 0.6}, {0.35, 0.2, 0.6}, 0.2, 0});
    return scene;
}

struct Subject {
    const char* group;
    std::string name;
    Scene scene;
};

std::vector<Subject> subjects(const StudyOptions& options) {
    if (options.is_scene_given) return {{kScenes, options.scene, load_scene(options.scene)}};
    std::vector<Subject> all;
    for (const char* name : kSceneNames) all.push_back({kScenes, name, load_scene(name)});
    all.push_back({kFloors, "diffuse", lamp_room("diffuse floor", kUsualLampEdge, {})});
    for (const double fuzz : kFuzzes)
        all.push_back({kFloors, fmt::format("metal, fuzz {:g}", fuzz),
                       lamp_room(fmt::format("metal floor {:g}", fuzz), kUsualLampEdge, metal(fuzz))});
    for (const double edge : kLampEdges)
        all.push_back({kLamps, fmt::format("{:g}", edge), lamp_room(fmt::format("lamp {:g}", edge), edge, {})});
    return all;
}

struct LightPlan {
    std::int64_t spp;
    int seeds;
    std::uint64_t first_seed;
    std::int32_t depth;
    int threads;

    [[nodiscard]] std::int64_t half_spp() const { return 16 * spp; }
};

LightPlan light_plan(const StudyOptions& options) {
    return {choose(options, options.spp, {16, 64}), static_cast<int>(choose(options, options.repeats, {5, 12})),
            options.seed, options.depth != 0 ? static_cast<std::int32_t>(options.depth) : Configuration{}.depth,
            options.threads != 0 ? options.threads : 1};
}

/// The fast pool in float.
Configuration configuration(const LightPlan& plan, LightSampling sampling) {
    Configuration with;
    with.depth = plan.depth;
    with.light_sampling = sampling;
    return with;
}

/// For each channel of each pixel whether no camera ray of the pixel meets what shines.
std::vector<bool> off_lamps(Scene scene) {
    constexpr std::int64_t kSpp = 1024;
    scene.background = {};
    Configuration first_hits;
    first_hits.depth = 1;
    const Values shining = render_image(first_hits, accuracy::SceneInBoth(scene), {0, kSpp, 0, core_count()}).values;
    std::vector<bool> is_off(shining.size());
    for (std::size_t i = 0; i < shining.size(); ++i) {
        const std::size_t pixel = i - i % 3;
        is_off[i] = shining[pixel] + shining[pixel + 1] + shining[pixel + 2] == 0;
    }
    return is_off;
}

/// The values of those channels.
Values chosen(const Values& values, const std::vector<bool>& is_chosen) {
    Values left;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (is_chosen[i]) left.push_back(values[i]);
    return left;
}

/// What images of a scene are held against: all of it, and what is off the lamps. The first has the depth and the
/// precision of what is measured, so that errors are noise.
struct Truth {
    accuracy::Halves all, off;
    std::vector<bool> is_off;
};
using SharedTruth = std::shared_ptr<Lazy<Truth>>;

SharedTruth truth_of(const SharedScene& scene, const std::shared_ptr<accuracy::Reference>& reference) {
    return std::make_shared<Lazy<Truth>>([=] {
        Truth truth{reference->halves(), {}, off_lamps(scene->description)};
        truth.off = {chosen(truth.all.a, truth.is_off), chosen(truth.all.b, truth.is_off)};
        return truth;
    });
}

Cells start_of_row(const char* kind, const Subject& subject, LightSampling sampling, const accuracy::SceneInBoth& scene,
                   int threads) {
    return {{"kind", kind},
            {"group", subject.group},
            {"subject", subject.name},
            {"light_sampling", to_string(sampling)},
            {"threads", threads},
            {"width", scene.in_float.width}};
}

/// The three ways, one after the other, with one seed.
Case seed_case(const Subject& subject, const SharedScene& scene, const SharedTruth& shared_truth, const LightPlan& plan,
               std::uint64_t seed) {
    const auto run = [=]() -> std::vector<Cells> {
        const Truth& truth = (*shared_truth)();
        std::vector<Cells> rows;
        std::string hash_by_chance;
        for (const LightSampling sampling : kModes) {
            const accuracy::TimedImage made =
                render_image(configuration(plan, sampling), *scene, {0, plan.spp, seed, plan.threads});
            if (sampling == LightSampling::None) hash_by_chance = made.hash;
            if (!scene->in_float.features.lights && made.hash != hash_by_chance)
                throw WrongImage(subject.name + ": light sampling changes an image without lights");
            const RenderReport& report = made.report;
            rows.push_back(start_of_row("run", subject, sampling, *scene, plan.threads) +
                           Cells{{"spp", plan.spp},
                                 {"seed", seed},
                                 {"seconds", report.seconds},
                                 {"paths", report.paths()},
                                 {"segments", report.segments()},
                                 {"shadow_rays", report.total(&ThreadReport::shadow_rays)},
                                 {"mse", corrected_mse(made.values, truth.all)},
                                 {"reference_noise", noise_of(truth.all)},
                                 {"pixels_off_lamps", truth.off.a.size() / 3},
                                 {"hash", made.hash}});
            if (!truth.off.a.empty())
                rows.back() =
                    rows.back() + Cells{{"mse_off_lamps", corrected_mse(chosen(made.values, truth.is_off), truth.off)}};
        }
        return rows;
    };
    return {fmt::format("{}: {}, seed {}", subject.group, subject.name, seed), "", 1, run};
}

std::vector<Case> light_cases(const StudyOptions& options) {
    const LightPlan plan = light_plan(options);
    const std::filesystem::path folder = options.folder.empty() ? "" : options.folder / "references";
    std::vector<Case> cases;
    std::vector<std::function<Case(std::uint64_t)>> by_seed;
    for (Subject& subject : subjects(options)) {
        set_width(subject.scene, choose(options, options.width, {40, 100}));
        const auto scene = std::make_shared<const accuracy::SceneInBoth>(subject.scene);
        const auto reference = std::make_shared<accuracy::Reference>(scene, plan.half_spp(), folder, core_count(),
                                                                     configuration(plan, LightSampling::Mis));
        for (int half = 0; half < 2; ++half)
            cases.push_back({fmt::format("reference: {}: {}, half {}", subject.group, subject.name, half), "", 1, [=] {
                                 reference->extend(plan.half_spp());
                                 return std::vector<Cells>{
                                     start_of_row("reference", subject, LightSampling::Mis, *scene, core_count())};
                             }});
        by_seed.emplace_back([=, truth = truth_of(scene, reference)](std::uint64_t seed) {
            return seed_case(subject, scene, truth, plan, seed);
        });
    }
    // A seed after the other; a row's comparison is with what stands beside it.
    for (int turn = 0; turn < plan.seeds; ++turn)
        for (const std::size_t i : turn_order(by_seed.size(), static_cast<std::size_t>(turn)))
            cases.push_back(by_seed[i](plan.first_seed + static_cast<std::uint64_t>(turn)));
    return cases;
}

}  // namespace

Study light_study() {
    return {
        .name = "light",
        .question = "How much sooner does an image have an error where lights are sampled, and where does it not pay?",
        .columns = {{"kind", ColumnType::Text, "reference (being made) or run"},
                    {"group", ColumnType::Text, "what is varied: the scene, or one thing in a room with a lamp"},
                    {"subject", ColumnType::Text,
                     "the scene; what the floor is made of; the edge of the lamp, over that of the ceiling"},
                    {"light_sampling", ColumnType::Text, "none (chance), light or mis"},
                    {"threads", ColumnType::Count, "OpenMP threads"},
                    {"width", ColumnType::Count, "image width, pixels"},
                    {"spp", ColumnType::Count, "samples for each pixel"},
                    {"seed", ColumnType::Count, "of all random numbers of the image"},
                    {"seconds", ColumnType::Real, "wall clock of the render: setup, loops, last pass"},
                    {"paths", ColumnType::Count, "samples of all pixels"},
                    {"segments", ColumnType::Count, "rays traced to their closest hits"},
                    {"shadow_rays", ColumnType::Count, "rays toward lights"},
                    {"mse", ColumnType::Signed, "squared error of linear radiance, less the noise of the reference"},
                    {"reference_noise", ColumnType::Real, "what was taken off"},
                    {"pixels_off_lamps", ColumnType::Count, "pixels none of whose camera rays meets what shines"},
                    {"mse_off_lamps", ColumnType::Signed, "the same error over these pixels alone"},
                    {"hash", ColumnType::Text, "of the sums of the image"}},
        .cases = light_cases};
}

}  // namespace raypool::studies
