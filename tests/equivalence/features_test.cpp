// Nothing a scene does not need: code compiled without a feature makes, of a scene that lacks it, the same image.

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "recursive/render.h"
#include "tests/equivalence/same_image.h"

namespace raypool {
namespace {

RenderSettings two_samples(LightSampling sampling) {
    RenderSettings settings;
    settings.end_sample = 2;
    settings.light_sampling = sampling;
    return settings;
}

/// One set of features compiled into the iterative tracer.
template <Features features>
Rendered render_with(const CompiledScene<float>& scene, LightSampling sampling = LightSampling::Mis) {
    const RenderSettings settings = two_samples(sampling);
    return rendered_by(scene, settings, [&](Framebuffer& framebuffer) {
        return render_whole(
            *recursive::begin<recursive::Form::Iterative, features, float, NoTestCount>(scene, settings, framebuffer),
            settings);
    });
}

constexpr Features everything_but(std::size_t feature) {
    Features features = kEverything;
    features.*kFeatureNames[feature].member = false;
    return features;
}

using RenderFunction = Rendered (*)(const CompiledScene<float>&, LightSampling);

/// For each feature, in the order of kFeatureNames, the tracer compiled without it.
constexpr auto kRenderWithout = []<std::size_t... feature>(std::index_sequence<feature...>) {
    return std::array<RenderFunction, sizeof...(feature)>{&render_with<everything_but(feature)>...};
}
(std::make_index_sequence<kFeatureNames.size()>());

const std::vector<std::string> kScenes{"paper",    "furnace",    "mirror_corridor", "glass_stack", "cornell",
                                       "half_sky", "one_sphere", "textures",        "sky_image",   "solids"};

class LeavingOut : public testing::TestWithParam<std::size_t> {};

TEST_P(LeavingOut, WhatASceneLacksChangesNoBit) {
    const FeatureName& feature = kFeatureNames[GetParam()];
    int lacking_count = 0;
    for (const std::string& name : kScenes) {
        const CompiledScene<float> scene = compile<float>(small_scene(name, 24));
        if (scene.features.*feature.member) continue;
        ++lacking_count;
        EXPECT_TRUE(same_image(fmt::format("without_{}_{}", feature.name, name), render_with<kEverything>(scene),
                               kRenderWithout[GetParam()](scene, LightSampling::Mis),
                               fmt::format("{} without {}", name, feature.name)));
    }
    EXPECT_GT(lacking_count, 0);
}

TEST_P(LeavingOut, WhatASceneNeedsChangesIt) {
    const FeatureName& feature = kFeatureNames[GetParam()];
    int needing_count = 0;
    for (const std::string& name : kScenes) {
        const CompiledScene<float> scene = compile<float>(small_scene(name, 24));
        if (!(scene.features.*feature.member) || name == "furnace") continue;  // a furnace shows no material
        ++needing_count;
        // Code without an image around the scene, or without triangles, cannot sample such lights.
        const bool is_light = feature.member == &Features::environment || feature.member == &Features::triangles;
        const auto sampling = is_light ? LightSampling::None : LightSampling::Mis;
        EXPECT_NE(kRenderWithout[GetParam()](scene, sampling).hash(), render_with<kEverything>(scene, sampling).hash())
            << name << " looks the same without " << feature.name;
    }
    EXPECT_GT(needing_count, 0);
}

INSTANTIATE_TEST_SUITE_P(Features, LeavingOut, testing::Range(std::size_t{0}, kFeatureNames.size()),
                         [](const auto& test) { return std::string(kFeatureNames[test.param].name); });

TEST(CompiledFeatures, WhichTheEngineChoosesMakeTheImageOfTheFullSet) {
    for (const std::string& name : kScenes) {
        const CompiledScene<float> scene = compile<float>(small_scene(name, 24));
        EXPECT_TRUE(same_image("chosen_" + name, render_with<kEverything>(scene),
                               render(recursive::IterativeEngine(), scene, two_samples(LightSampling::Mis)), name));
    }
}

/// Two diffuse spheres on a large one, in which there is room for what no ray gets to.
Scene plain_scene() {
    Scene scene;
    scene.width = 24;
    scene.height = 16;
    scene.camera.look_from = {0, 2, 8};
    scene.camera.look_at = {0, 1, 0};
    scene.camera.shutter_close = 1;
    scene.background = {{1, 1, 1}, {0.3, 0.5, 1}};
    for (const double grey : {0.5, 0.8}) scene.textures.emplace_back().even = Vector3d(grey, 0.9 * grey, 0.7);
    scene.materials = {{Material::Kind::Diffuse, 0}, {Material::Kind::Diffuse, 1}};
    scene.spheres = {
        {{0, -1000, 0}, {0, -1000, 0}, 1000, 0}, {{-1, 1, 0}, {-1, 1, 0}, 1, 0}, {{1, 1, 0}, {1, 1, 0}, 1, 1}};
    return scene;
}

/// Hides a sphere of this material and texture (and perhaps moving) within the ground.
Scene with_hidden(Material material, Texture texture, const Vector3d& motion = Vector3d::Zero()) {
    Scene scene = plain_scene();
    material.texture_id = static_cast<std::int32_t>(scene.textures.size());
    scene.textures.push_back(std::move(texture));
    scene.materials.push_back(material);
    const Vector3d center(0, -20, 0);
    scene.spheres.push_back({center, center + motion, 1, static_cast<std::int32_t>(scene.materials.size()) - 1});
    return scene;
}

TEST(NeutralTwin, OfEveryFeatureIsTheSameImage) {
    const auto solid = [] {
        Texture texture;
        texture.even = Vector3d(0.2, 0.4, 0.6);
        return texture;
    };
    const auto textured = [&](Texture::Kind kind) {
        Texture texture = solid();
        texture.kind = kind;
        return texture;
    };
    using Kind = Material::Kind;
    std::vector<std::pair<bool Features::*, Scene>> twins{
        {&Features::motion, with_hidden({Kind::Diffuse}, solid(), {0, 1, 0})},
        {&Features::metal, with_hidden({Kind::Metal}, solid())},
        {&Features::fuzz, with_hidden({Kind::Metal, 0, 0.5}, solid())},
        {&Features::dielectric, with_hidden({Kind::Dielectric, 0, 0, 1.5}, solid())},
        {&Features::emissive, with_hidden({Kind::Emissive}, solid())},
        {&Features::checker, with_hidden({Kind::Diffuse}, textured(Texture::Kind::Checker3d))},
        {&Features::uv, with_hidden({Kind::Diffuse}, textured(Texture::Kind::CheckerUv))},
    };
    // A quad below ground, and a lens whose radius is zero in float; the plane of focus is where a pinhole's film is.
    twins.emplace_back(&Features::planar, plain_scene()).second.quads.push_back({{0, -20, 0}, {1, 0, 0}, {0, 1, 0}, 0});
    CameraDescription& lens = twins.emplace_back(&Features::defocus, plain_scene()).second.camera;
    lens.defocus_angle_degrees = 1e-60;
    lens.focus_distance = 1;

    // Without light sampling, with which sums of a scene that has lights go by other steps.
    const auto render_twin = [](const CompiledScene<float>& scene) {
        return render_with<kEverything>(scene, LightSampling::None);
    };
    const Rendered plain = render_twin(compile<float>(plain_scene()));
    for (const auto& twin : twins) {
        bool Features::*feature = twin.first;
        const auto named = std::find_if(kFeatureNames.begin(), kFeatureNames.end(),
                                        [&](const FeatureName& f) { return f.member == feature; });
        const CompiledScene<float> compiled = compile<float>(twin.second);
        EXPECT_FALSE(compile<float>(plain_scene()).features.*feature);
        EXPECT_TRUE(compiled.features.*feature) << named->name;
        EXPECT_TRUE(same_image(fmt::format("twin_{}", named->name), plain, render_twin(compiled),
                               fmt::format("a neutral {}", named->name)));
    }
}

/// An image of one colour is a background of that colour.
TEST(NeutralTwin, OfAnImageAroundTheSceneIsTheSameImage) {
    Scene scene = plain_scene();
    const Vector3d sky(1, 0.75, 0.5);
    scene.background = {sky, sky};
    const Rendered plain = render_with<kEverything>(compile<float>(scene), LightSampling::None);
    auto image = std::make_shared<Image>(8, 4);
    for (std::size_t i = 0; i < image->rgb.size(); ++i) image->rgb[i] = static_cast<float>(sky[i % 3]) / 2;
    scene.background = {};
    scene.background.image = image;
    scene.background.scale = 2;
    const CompiledScene<float> compiled = compile<float>(scene);
    EXPECT_TRUE(compiled.features.environment);
    EXPECT_TRUE(same_image("twin_environment", plain, render_with<kEverything>(compiled, LightSampling::None),
                           "an image of one colour"));
}

}  // namespace
}  // namespace raypool
