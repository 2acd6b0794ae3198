#include "core/film/light_range.h"

#include <algorithm>
#include <limits>

namespace raypool {

double dimmest_light(const Scene& scene) {
    double least = std::numeric_limits<double>::infinity();
    const auto add = [&](const Vector3d& radiance, double strength = 1) {
        for (const double channel : radiance)
            if (channel > 0) least = std::min(least, strength * channel);
    };
    const auto add_shapes = [&](const auto& shapes) {
        for (const auto& shape : shapes) {
            const Material& material = scene.materials[static_cast<std::size_t>(shape.material_id)];
            if (material.kind != Material::Kind::Emissive) continue;
            const Texture& texture = scene.textures[static_cast<std::size_t>(material.texture_id)];
            if (texture.kind != Texture::Kind::Image) add(texture.even, material.strength);
            if (texture.kind == Texture::Kind::Checker3d || texture.kind == Texture::Kind::CheckerUv)
                add(texture.odd, material.strength);
        }
    };
    const Background& background = scene.background;
    add(background.bottom);
    add(background.top);
    if (background.image) {
        for (const float channel : background.image->rgb)
            if (channel > 0) least = std::min(least, background.scale * channel);
    }
    add_shapes(scene.spheres);
    add_shapes(scene.quads);
    add_shapes(scene.planes);
    add_shapes(scene.meshes);
    return least < std::numeric_limits<double>::infinity() ? least : 0;
}

}  // namespace raypool
