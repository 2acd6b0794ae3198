#include "core/scene/emission.h"

#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

namespace raypool {

double mean_radiance(const Scene& scene, const Material& material) {
    if (material.kind != Material::Kind::Emissive) return 0;
    const Texture& texture = scene.textures[static_cast<std::size_t>(material.texture_id)];
    switch (texture.kind) {
        case Texture::Kind::Solid:
            return material.strength * texture.even.mean();
        case Texture::Kind::Checker3d:
        case Texture::Kind::CheckerUv:
            return material.strength * (texture.even.mean() + texture.odd.mean()) / 2;
        case Texture::Kind::Image:
            break;
    }
    const std::vector<float>& texels = texture.image->rgb;
    return material.strength * std::accumulate(texels.begin(), texels.end(), 0.0) / static_cast<double>(texels.size());
}

double emitted_power(const Scene& scene, const Sphere& sphere) {
    const double radiance = mean_radiance(scene, scene.materials[static_cast<std::size_t>(sphere.material_id)]);
    return radiance * 4 * std::numbers::pi * sphere.radius * sphere.radius;
}

double emitted_power(const Scene& scene, const Quad& quad) {
    const Material& material = scene.materials[static_cast<std::size_t>(quad.material_id)];
    const double area = quad.edge_u.cross(quad.edge_v).norm();
    return mean_radiance(scene, material) * area * (material.front_only ? 1 : 2);
}

}  // namespace raypool
