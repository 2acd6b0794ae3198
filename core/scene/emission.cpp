#include "core/scene/emission.h"

#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

namespace raypool {

namespace {

double mean_colour(const Texture& texture) {
    switch (texture.kind) {
        case Texture::Kind::Solid:
            return texture.even.mean();
        case Texture::Kind::Checker3d:
        case Texture::Kind::CheckerUv:
            return (texture.even.mean() + texture.odd.mean()) / 2;
        case Texture::Kind::Image:
            break;
    }
    const std::vector<float>& texels = texture.image->rgb;
    return std::accumulate(texels.begin(), texels.end(), 0.0) / static_cast<double>(texels.size());
}

}  // namespace

EmittedPower::EmittedPower(const Scene& scene) : scene_(scene) {
    for (const Material& material : scene.materials) {
        const bool is_emitter = material.kind == Material::Kind::Emissive;
        mean_radiance_.push_back(
            is_emitter ? material.strength * mean_colour(scene.textures[static_cast<std::size_t>(material.texture_id)])
                       : 0);
    }
}

double EmittedPower::of(const Sphere& sphere) const {
    const double area = 4 * std::numbers::pi * sphere.radius * sphere.radius;
    return mean_radiance_[static_cast<std::size_t>(sphere.material_id)] * area;
}

double EmittedPower::of(const Quad& quad) const {
    const auto material_id = static_cast<std::size_t>(quad.material_id);
    const double area = quad.edge_u.cross(quad.edge_v).norm();
    return mean_radiance_[material_id] * area * (scene_.materials[material_id].front_only ? 1 : 2);
}

}  // namespace raypool
