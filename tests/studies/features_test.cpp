// Study `needs`: a scene without features, and code compiled for each of them that makes one image of it.

#include <gtest/gtest.h>

#include "bench/studies/feature_engines.h"
#include "bench/studies/plain_scene.h"
#include "core/base/error.h"
#include "tests/small_render.h"
#include "wavefront/pool_report.h"

namespace raypool::studies {
namespace {

TEST(PlainScene, NeedsNothingWhateverItIsMadeOf) {
    for (const char* name : {"paper", "furnace", "mirror_corridor", "glass_stack", "textures"}) {
        const Scene scene = small_scene(name, 24);
        const Scene plain = plain_scene(scene);
        EXPECT_TRUE(feature_names(scene_features(plain)).empty()) << name;
        EXPECT_EQ(plain.spheres.size(), scene.spheres.size()) << name;
        const CompiledScene<float> compiled = compile<float>(plain);
        EXPECT_LE(compiled.max_radiance, compile<float>(scene).max_radiance) << name;
    }
}

TEST(PlainScene, IsRefusedWhereThereAreNoSpheres) {
    Scene scene = small_scene("paper", 24);
    scene.spheres.clear();
    EXPECT_THROW(plain_scene(scene), InputError);
}

TEST(FeatureSets, HaveOneFeatureEachAndFuzzItsMetal) {
    for (std::size_t i = 0; i < kFeatureNames.size(); ++i) {
        const std::vector<std::string> names = feature_names(kFeatureSets[i].features);
        const std::string name = kFeatureNames[i].name;
        EXPECT_EQ(kFeatureSets[i].name, name);
        std::vector<std::string> expected{name};  // and what it is a kind of
        if (name == "fuzz") expected = {"metal", name};
        if (name == "triangles") expected = {"planar", name};
        EXPECT_EQ(names, expected);
    }
}

/// The image of the plain paper scene by each set of features.
TEST(FeatureSets, MakeOneImageOfAPlainScene) {
    const CompiledScene<float> scene = compile<float>(plain_scene(small_scene("paper", 32)));
    RenderSettings settings;
    settings.end_sample = 2;
    const std::string expected = render(recursive::RecursiveEngine(), scene, settings).hash();
    for (std::size_t i = 0; i < kFeatureSets.size(); ++i) {
        for (const BeginFunction begin : {iterative_begin(i), pool_begin(i)}) {
            const Rendered got = rendered_by(scene, settings, [&](Framebuffer& framebuffer) {
                return render_whole(*begin(scene, settings, framebuffer), settings);
            });
            EXPECT_EQ(got.hash(), expected) << kFeatureSets[i].name;
            if (wavefront::pool_report(got.report).record_bytes != 0) {
                EXPECT_EQ(wavefront::pool_report(got.report).record_bytes,
                          ray_record_bytes(kFeatureSets[i].features, sizeof(float)));
            }
        }
    }
}

/// The right function in the right place: each makes the image that the full set makes of a scene with that feature.
TEST(FeatureSets, CanDoWhatTheirFeatureIs) {
    RenderSettings settings;
    settings.end_sample = 2;
    Scene moving = plain_scene(small_scene("paper", 32));
    for (Sphere& sphere : moving.spheres) sphere.center1 += Vector3d(0, 0.3, 0);
    Scene blurred = plain_scene(small_scene("paper", 32));
    blurred.camera.defocus_angle_degrees = 5;
    Scene glass = plain_scene(small_scene("paper", 32));
    for (Material& material : glass.materials) material = {Material::Kind::Dielectric, 0, 0, 1.5};
    Scene checkered = plain_scene(small_scene("paper", 32));
    for (Texture& texture : checkered.textures) texture.kind = Texture::Kind::Checker3d;
    for (const Scene& scene : {moving, blurred, glass, checkered}) {
        const CompiledScene<float> compiled = compile<float>(scene);
        const std::vector<std::string> names = feature_names(compiled.features);
        ASSERT_EQ(names.size(), 1U);
        const std::string expected = render(recursive::RecursiveEngine(), compiled, settings).hash();
        for (std::size_t i = 0; i < kFeatureSets.size(); ++i) {
            if (kFeatureSets[i].name != names[0]) continue;
            for (const BeginFunction begin : {iterative_begin(i), pool_begin(i)}) {
                const Rendered got = rendered_by(compiled, settings, [&](Framebuffer& framebuffer) {
                    return render_whole(*begin(compiled, settings, framebuffer), settings);
                });
                EXPECT_EQ(got.hash(), expected) << names[0];
            }
        }
    }
}

}  // namespace
}  // namespace raypool::studies
