/// What a scene needs is what its shapes use, no more and no less.
#include "core/scene/features.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/scene/scene_reader.h"

namespace raypool::test {
namespace {

/// A scene with one material of every kind and one texture of every kind, and no shapes.
Scene palette() {
    Scene scene;
    for (const auto kind :
         {Texture::Kind::Solid, Texture::Kind::Checker3d, Texture::Kind::CheckerUv, Texture::Kind::Image})
        scene.textures.emplace_back().kind = kind;
    const auto add = [&](Material::Kind kind, std::int32_t texture_id, double fuzz) {
        Material& material = scene.materials.emplace_back();
        material.kind = kind;
        material.texture_id = texture_id;
        material.fuzz = fuzz;
    };
    add(Material::Kind::Diffuse, 0, 0);
    add(Material::Kind::Metal, 0, 0);
    add(Material::Kind::Metal, 0, 0.1);
    add(Material::Kind::Dielectric, 3, 0.1);  // what glass does not use does not count
    add(Material::Kind::Emissive, 0, 0.1);    // likewise
    add(Material::Kind::Diffuse, 1, 0);
    add(Material::Kind::Diffuse, 2, 0);
    add(Material::Kind::Diffuse, 3, 0);
    return scene;
}
Scene with_sphere(std::int32_t material_id) {
    Scene scene = palette();
    scene.spheres.emplace_back().material_id = material_id;
    return scene;
}

TEST(Features, AreNoneOfMaterialsThatNoShapeUses) {
    EXPECT_EQ(scene_features(palette()), Features{});
    EXPECT_EQ(scene_features(with_sphere(0)), Features{});
}

TEST(Features, FollowTheMaterialsOfEveryKindOfShape) {
    const std::vector<Features> expected{{},
                                         {.metal = true},
                                         {.metal = true, .fuzz = true},
                                         {.dielectric = true},
                                         {.emissive = true},
                                         {.checker = true},
                                         {.uv = true},
                                         {.uv = true}};
    for (std::int32_t material_id = 0; material_id < 8; ++material_id) {
        Features features = expected[static_cast<std::size_t>(material_id)];
        EXPECT_EQ(scene_features(with_sphere(material_id)), features) << material_id;
        features.planar = true;
        Scene scene = palette();
        scene.quads.emplace_back().material_id = material_id;
        EXPECT_EQ(scene_features(scene), features) << material_id;
        scene = palette();
        scene.planes.emplace_back().material_id = material_id;
        EXPECT_EQ(scene_features(scene), features) << material_id;
    }
}

TEST(Features, IncludeMotionOnlyWhereSomethingMovesWhileTheShutterIsOpen) {
    Scene scene = with_sphere(0);
    scene.camera.shutter_close = 1;
    EXPECT_FALSE(scene_features(scene).motion);
    scene.spheres[0].center1 = {0, 0.5, 0};
    EXPECT_TRUE(scene_features(scene).motion);
    scene.camera.shutter_open = 1;  // an instant, but not that of center0
    EXPECT_TRUE(scene_features(scene).motion);
    scene.camera.shutter_open = scene.camera.shutter_close = 0;
    EXPECT_FALSE(scene_features(scene).motion);
}

TEST(Features, IncludeDefocusOnlyWithALens) {
    Scene scene = palette();
    scene.camera.focus_distance = 10;
    EXPECT_FALSE(scene_features(scene).defocus);
    scene.camera.defocus_angle_degrees = 0.1;
    EXPECT_TRUE(scene_features(scene).defocus);
}

TEST(Features, IncludeAnImageAroundTheSceneAndLightsUnlessItIsBlack) {
    Scene scene = with_sphere(0);
    auto image = std::make_shared<Image>(2, 1);
    scene.background.image = image;
    EXPECT_EQ(scene_features(scene), Features{.environment = true});
    image->rgb[4] = 0.5;
    EXPECT_EQ(scene_features(scene), (Features{.lights = true, .environment = true}));
}

TEST(Features, RunOnTheSmallestCompiledSetThatCoversThem) {
    for (const std::string& name : builtin_scene_names()) {
        const Features features = scene_features(builtin_scene(name));
        const std::size_t index = compiled_features_index(features);
        EXPECT_TRUE(covers(kCompiledFeatures[index], features)) << name;
        for (std::size_t i = 0; i < index; ++i) EXPECT_FALSE(covers(kCompiledFeatures[i], features)) << name;
        const bool is_dispatched =
            dispatch_features(features, [&]<Features compiled>() { return compiled == kCompiledFeatures[index]; });
        EXPECT_TRUE(is_dispatched) << name;
    }
    EXPECT_EQ(compiled_features_index({}), 0U);
    EXPECT_EQ(compiled_features_index(kEverything), kCompiledFeatures.size() - 1);
}

TEST(Features, AreListedByNameOneByOne) {
    for (const FeatureName& feature : kFeatureNames) {
        Features features;
        features.*feature.member = true;
        EXPECT_EQ(feature_names(features), std::vector<std::string>{feature.name});
        EXPECT_TRUE(covers(kEverything, features));
        EXPECT_FALSE(covers({}, features));
    }
    EXPECT_EQ(feature_names(kEverything).size(), kFeatureNames.size());
}

TEST(RayRecord, GrowsOnlyWithWhatMustOutliveASegment) {
    const std::size_t least = ray_record_bytes({}, sizeof(float));
    EXPECT_EQ(least, 52U);
    EXPECT_EQ(ray_record_bytes({}, sizeof(double)), 88U);
    for (const FeatureName& feature : kFeatureNames) {
        Features features;
        features.*feature.member = true;
        const bool is_carried = feature.member == &Features::motion || feature.member == &Features::lights;
        EXPECT_EQ(ray_record_bytes(features, sizeof(float)), least + (is_carried ? 4 : 0)) << feature.name;
    }
    EXPECT_LE(ray_record_bytes(kEverything, sizeof(float)), 64U);
}

}  // namespace
}  // namespace raypool::test
