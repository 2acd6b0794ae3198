#include "core/scene/features.h"

#include "core/scene/emission.h"

namespace raypool {

namespace {

Features texture_features(const Texture& texture) {
    Features features;
    features.checker = texture.kind == Texture::Kind::Checker3d;
    features.uv = texture.needs_uv();
    return features;
}

Features material_features(const Scene& scene, const Material& material) {
    Features features;
    if (material.kind == Material::Kind::Dielectric) {
        features.dielectric = true;
        return features;
    }
    features = texture_features(scene.textures[material.texture_id]);
    features.metal = material.kind == Material::Kind::Metal;
    features.fuzz = features.metal && material.fuzz > 0;
    features.emissive = material.kind == Material::Kind::Emissive;
    return features;
}

}  // namespace

Features scene_features(const Scene& scene) {
    Features features;
    const EmittedPower power(scene);
    const auto add_material = [&](int material_id) {
        const Features more = material_features(scene, scene.materials[material_id]);
        for (const FeatureName& feature : kFeatureNames) features.*feature.member |= more.*feature.member;
    };
    for (const Sphere& sphere : scene.spheres) {
        add_material(sphere.material_id);
        // With a shutter that opens and closes at time 0 nothing has moved yet.
        features.motion |= sphere.center0 != sphere.center1 && scene.camera.shutter_close > 0;
        features.lights |= power.of(sphere) > 0;
    }
    for (const Quad& quad : scene.quads) {
        add_material(quad.material_id);
        features.lights |= power.of(quad) > 0;
    }
    for (const Plane& plane : scene.planes) add_material(plane.material_id);
    features.environment = scene.background.image != nullptr;
    features.lights |= power.of(scene.background) > 0;
    for (const MeshShape& mesh : scene.meshes) {
        add_material(mesh.material_id);
        features.lights |= power.of(mesh, 1) > 0;
    }
    features.triangles = !scene.meshes.empty();
    features.planar = !scene.quads.empty() || !scene.planes.empty() || features.triangles;
    features.defocus = scene.camera.defocus_angle_degrees > 0;
    return features;
}

std::vector<std::string> feature_names(const Features& features) {
    std::vector<std::string> names;
    for (const FeatureName& feature : kFeatureNames)
        if (features.*feature.member) names.emplace_back(feature.name);
    return names;
}

}  // namespace raypool
