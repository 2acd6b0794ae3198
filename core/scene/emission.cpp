#include "core/scene/emission.h"

#include <cmath>
#include <map>
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

/// Of the sphere around the box of all shapes that have an end; 1 where there is none, and no other light to choose.
double enclosing_radius(const Scene& scene) {
    Eigen::AlignedBox3d box;
    for (const Sphere& sphere : scene.spheres) {
        const Vector3d reach = Vector3d::Constant(sphere.radius);
        for (const Vector3d& center : {sphere.center0, sphere.center1})
            box.extend(center - reach).extend(center + reach);
    }
    for (const Quad& quad : scene.quads) {
        for (const Vector3d& corner : {quad.corner, Vector3d(quad.corner + quad.edge_u)})
            box.extend(corner).extend(Vector3d(corner + quad.edge_v));
    }
    std::map<const Mesh*, Mesh::Box> boxes;  // of objects: they may have very many instances
    for (const MeshShape& shape : scene.meshes) {
        if (shape.is_instance) {
            const auto [found, is_new] = boxes.try_emplace(shape.mesh.get());
            if (is_new) found->second = shape.mesh->box();
            for (const auto& corner : found->second.corners()) box.extend(shape.placed(corner));
        } else {
            for (const auto& position : shape.mesh->positions) box.extend(shape.placed(position));
        }
    }
    return box.isEmpty() ? 1 : box.diagonal().norm() / 2;
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
    return of_flat(quad.material_id, quad.edge_u.cross(quad.edge_v).norm());
}

double EmittedPower::of(const MeshShape& mesh, double area) const {
    return of_flat(mesh.material_id, area);
}

double EmittedPower::of_flat(std::int32_t material_id, double area) const {
    const auto material = static_cast<std::size_t>(material_id);
    return mean_radiance_[material] * area * (scene_.materials[material].front_only ? 1 : 2);
}

double EmittedPower::of(const Background& background) const {
    if (!background.image) return 0;
    const Image& image = *background.image;
    double radiance = 0;  // times solid angle
    for (std::int64_t row = 0; row < image.height; ++row) {
        const float* first = image.pixel(0, row);
        radiance += std::accumulate(first, first + 3 * image.width, 0.0) / 3 * texel_solid_angle(image, row);
    }
    const double radius = enclosing_radius(scene_);
    return background.scale * radiance * radius * radius;  // the area 4 pi r^2 times the mean over 4 pi
}

double texel_solid_angle(const Image& image, std::int64_t row) {
    const double half = std::numbers::pi / static_cast<double>(image.height) / 2;
    const double middle = half * static_cast<double>(2 * row + 1);
    // The difference of the cosines of its edges, without cancellation.
    return 2 * std::numbers::pi / static_cast<double>(image.width) * 2 * std::sin(middle) * std::sin(half);
}

}  // namespace raypool
