#include "core/needs.h"

namespace raypool {

namespace {

SceneNeeds texture_needs(const Texture& texture) {
    SceneNeeds needs;
    needs.checker = texture.kind == Texture::Kind::Checker3d;
    needs.uv = texture.kind == Texture::Kind::CheckerUv || texture.kind == Texture::Kind::Image;
    return needs;
}

SceneNeeds material_needs(const Scene& scene, const Material& material) {
    SceneNeeds needs;
    if (material.kind == Material::Kind::Dielectric) {
        needs.dielectric = true;
        return needs;
    }
    needs = texture_needs(scene.textures[material.texture_id]);
    needs.metal = material.kind == Material::Kind::Metal;
    needs.fuzz = needs.metal && material.fuzz > 0;
    needs.emissive = material.kind == Material::Kind::Emissive;
    return needs;
}

}  // namespace

SceneNeeds scene_needs(const Scene& scene) {
    SceneNeeds needs;
    const auto add_material = [&](int material_id) {
        const SceneNeeds more = material_needs(scene, scene.materials[material_id]);
        for (const SceneFeature& feature : kSceneFeatures) needs.*feature.member |= more.*feature.member;
    };
    for (const Sphere& sphere : scene.spheres) {
        add_material(sphere.material_id);
        // With a shutter that opens and closes at time 0 nothing has moved yet.
        needs.motion |= sphere.center0 != sphere.center1 && scene.camera.shutter_close > 0;
    }
    for (const Quad& quad : scene.quads) add_material(quad.material_id);
    for (const Plane& plane : scene.planes) add_material(plane.material_id);
    needs.flat = !scene.quads.empty() || !scene.planes.empty();
    needs.defocus = scene.camera.defocus_angle_degrees > 0;
    return needs;
}

std::vector<std::string> feature_names(const SceneNeeds& needs) {
    std::vector<std::string> names;
    for (const SceneFeature& feature : kSceneFeatures)
        if (needs.*feature.member) names.emplace_back(feature.name);
    return names;
}

}  // namespace raypool
