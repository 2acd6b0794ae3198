/// Scenes made in a test, a line for each thing in them, and estimates from their renders.
#pragma once

#include <cmath>
#include <memory>

#include "tests/small_render.h"

namespace raypool {

struct TestScene : Scene {
    TestScene(std::int64_t image_width, std::int64_t image_height, const Vector3d& sky) {
        width = image_width;
        height = image_height;
        background = {sky, sky};
    }

    void look(const Vector3d& from, const Vector3d& at, double vertical_fov_degrees) {
        camera.look_from = from;
        camera.look_at = at;
        camera.up = std::abs((at - from).normalized().y()) < 0.99 ? Vector3d::UnitY() : Vector3d::UnitX();
        camera.vertical_fov_degrees = vertical_fov_degrees;
    }
    std::int32_t diffuse(double albedo) { return add(Material::Kind::Diffuse, albedo); }
    std::int32_t mirror(double albedo) { return add(Material::Kind::Metal, albedo); }
    std::int32_t emitter(double radiance) { return add(Material::Kind::Emissive, radiance); }
    std::int32_t glass(double ior) {
        const std::int32_t id = add(Material::Kind::Dielectric, 0);
        materials.back().ior = ior;
        return id;
    }
    void sphere(const Vector3d& center, double radius, std::int32_t material) {
        spheres.push_back({center, center, radius, material});
    }
    void plane(const Vector3d& point, const Vector3d& normal, std::int32_t material) {
        planes.push_back({point, normal, material});
    }
    void quad(const Vector3d& corner, const Vector3d& edge_u, const Vector3d& edge_v, std::int32_t material) {
        quads.push_back({corner, edge_u, edge_v, material});
    }
    void mesh(Mesh triangles, std::int32_t material, double scale = 1, const Vector3d& offset = Vector3d::Zero()) {
        MeshShape shape{std::make_shared<const Mesh>(std::move(triangles))};
        shape.transform.leftCols<3>() *= scale;
        shape.transform.col(3) = offset;
        shape.material_id = material;
        meshes.push_back(std::move(shape));
    }

  private:
    std::int32_t add(Material::Kind kind, double grey) {
        Texture texture;
        texture.even = Vector3d::Constant(grey);
        textures.push_back(texture);
        Material material;
        material.kind = kind;
        material.texture_id = static_cast<std::int32_t>(textures.size()) - 1;
        materials.push_back(material);
        return static_cast<std::int32_t>(materials.size()) - 1;
    }
};

/// Of twice as many columns as rows, for a background: each texel is radiance(column, row).
template <class Radiance>
std::shared_ptr<const Image> image_of(std::int64_t height, Radiance radiance) {
    auto image = std::make_shared<Image>(2 * height, height);
    for (std::int64_t row = 0; row < height; ++row) {
        for (std::int64_t column = 0; column < 2 * height; ++column) {
            const Vector3d texel = radiance(column, row);
            for (int i = 0; i < 3; ++i) image->pixel(column, row)[i] = static_cast<float>(texel[i]);
        }
    }
    return image;
}

/// The radiance of every pixel in the first channel, in the order of the framebuffer, exactly as summed.
inline std::vector<double> pixel_values(const Rendered& rendered) {
    std::vector<double> values;
    const double scale = rendered.framebuffer.fixed_point().scale() * static_cast<double>(rendered.sample_count);
    for (std::size_t i = 0; i < rendered.framebuffer.sums().size(); i += 3)
        values.push_back(static_cast<double>(rendered.framebuffer.sums()[i]) / scale);
    return values;
}

/// Paths whose first segment met a surface that sends light on.
template <class Scalar>
std::int64_t hit_count(const Scene& scene, std::int64_t spp) {
    const RenderReport report = render<Scalar>(scene, spp, 2).report;
    return report.segments() - report.paths();
}

}  // namespace raypool
