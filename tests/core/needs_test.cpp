/// What a scene needs is what its shapes use, no more and no less.
#include "core/needs.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/scene_reader.h"

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

TEST(SceneNeeds, AreNoneOfMaterialsThatNoShapeUses) {
    EXPECT_EQ(scene_needs(palette()), SceneNeeds{});
    EXPECT_EQ(scene_needs(with_sphere(0)), SceneNeeds{});
}

TEST(SceneNeeds, FollowTheMaterialsOfEveryKindOfShape) {
    const std::vector<SceneNeeds> expected{{},
                                           {.metal = true},
                                           {.metal = true, .fuzz = true},
                                           {.dielectric = true},
                                           {.emissive = true},
                                           {.checker = true},
                                           {.uv = true},
                                           {.uv = true}};
    for (std::int32_t material_id = 0; material_id < 8; ++material_id) {
        SceneNeeds needs = expected[static_cast<std::size_t>(material_id)];
        EXPECT_EQ(scene_needs(with_sphere(material_id)), needs) << material_id;
        needs.flat = true;
        Scene scene = palette();
        scene.quads.emplace_back().material_id = material_id;
        EXPECT_EQ(scene_needs(scene), needs) << material_id;
        scene = palette();
        scene.planes.emplace_back().material_id = material_id;
        EXPECT_EQ(scene_needs(scene), needs) << material_id;
    }
}

TEST(SceneNeeds, IncludeMotionOnlyWhereSomethingMovesWhileTheShutterIsOpen) {
    Scene scene = with_sphere(0);
    scene.camera.shutter_close = 1;
    EXPECT_FALSE(scene_needs(scene).motion);
    scene.spheres[0].center1 = {0, 0.5, 0};
    EXPECT_TRUE(scene_needs(scene).motion);
    scene.camera.shutter_open = 1;  // an instant, but not that of center0
    EXPECT_TRUE(scene_needs(scene).motion);
    scene.camera.shutter_open = scene.camera.shutter_close = 0;
    EXPECT_FALSE(scene_needs(scene).motion);
}

TEST(SceneNeeds, IncludeDefocusOnlyWithALens) {
    Scene scene = palette();
    scene.camera.focus_distance = 10;
    EXPECT_FALSE(scene_needs(scene).defocus);
    scene.camera.defocus_angle_degrees = 0.1;
    EXPECT_TRUE(scene_needs(scene).defocus);
}

TEST(SceneNeeds, RunOnTheSmallestCompiledSetThatCoversThem) {
    for (const std::string& name : builtin_scene_names()) {
        const SceneNeeds needs = scene_needs(builtin_scene(name));
        const std::size_t index = compiled_needs_index(needs);
        EXPECT_TRUE(covers(kCompiledNeeds[index], needs)) << name;
        for (std::size_t i = 0; i < index; ++i) EXPECT_FALSE(covers(kCompiledNeeds[i], needs)) << name;
        const bool is_dispatched =
            dispatch_needs(needs, [&]<SceneNeeds compiled>() { return compiled == kCompiledNeeds[index]; });
        EXPECT_TRUE(is_dispatched) << name;
    }
    EXPECT_EQ(compiled_needs_index({}), 0U);
    EXPECT_EQ(compiled_needs_index(kEverything), kCompiledNeeds.size() - 1);
}

TEST(SceneNeeds, AreListedByNameOneByOne) {
    for (const SceneFeature& feature : kSceneFeatures) {
        SceneNeeds needs;
        needs.*feature.member = true;
        EXPECT_EQ(feature_names(needs), std::vector<std::string>{feature.name});
        EXPECT_TRUE(covers(kEverything, needs));
        EXPECT_FALSE(covers({}, needs));
    }
    EXPECT_EQ(feature_names(kEverything).size(), kSceneFeatures.size());
}

TEST(RayRecord, GrowsOnlyWithWhatMustOutliveASegment) {
    const std::size_t least = ray_record_bytes({}, sizeof(float));
    EXPECT_EQ(least, 52U);
    EXPECT_EQ(ray_record_bytes({}, sizeof(double)), 88U);
    for (const SceneFeature& feature : kSceneFeatures) {
        SceneNeeds needs;
        needs.*feature.member = true;
        const bool is_carried = feature.member == &SceneNeeds::motion;
        EXPECT_EQ(ray_record_bytes(needs, sizeof(float)), least + (is_carried ? 4 : 0)) << feature.name;
    }
    EXPECT_LE(ray_record_bytes(kEverything, sizeof(float)), 64U);
}

}  // namespace
}  // namespace raypool::test
