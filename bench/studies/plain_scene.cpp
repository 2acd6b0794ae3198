#include "bench/studies/plain_scene.h"

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool::studies {

Scene plain_scene(const Scene& scene) {
    if (scene.spheres.empty())
        throw InputError(fmt::format("--scene: {} has no spheres, which is what a plain scene is made of", scene.name));
    Scene plain = scene;
    plain.name += ", plain";
    plain.quads.clear();
    plain.planes.clear();
    plain.camera.defocus_angle_degrees = 0;
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

}  // namespace raypool::studies
