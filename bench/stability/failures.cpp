#include "bench/stability/failures.h"

#include <cmath>

#include <Eigen/Geometry>

#include "recursive/engine.h"

namespace raypool::stability {

namespace {

class Builder {
  public:
    explicit Builder(double field_of_view) {
        scene.description = "A scene of the stability study.";
        scene.width = 240;
        scene.height = 160;
        scene.camera.vertical_fov_degrees = field_of_view;
        scene.background = {Vector3d(1, 1, 1), Vector3d(0.45, 0.65, 1)};
    }
    std::int32_t diffuse(const Vector3d& albedo) { return add({Material::Kind::Diffuse, solid(albedo)}); }
    std::int32_t glass() { return add({.kind = Material::Kind::Dielectric, .ior = 1.5}); }
    std::int32_t checker(double edge, const Vector3d& offset) {
        Texture texture;
        texture.kind = Texture::Kind::Checker3d;
        texture.even = Vector3d(0.12, 0.2, 0.3);
        texture.odd = Vector3d(0.9, 0.88, 0.8);
        texture.scale = edge;
        texture.offset = offset;
        scene.textures.push_back(texture);
        return add({Material::Kind::Diffuse, static_cast<std::int32_t>(scene.textures.size()) - 1});
    }
    void sphere(const Vector3d& center, double radius, std::int32_t material) {
        scene.spheres.push_back({center, center, radius, material});
    }
    void look(const Vector3d& from, const Vector3d& at) {
        scene.camera.look_from = from;
        scene.camera.look_at = at;
    }
    /// Everything, the camera too, somewhere else.
    void move(const Vector3d& by) {
        scene.camera.look_from += by;
        scene.camera.look_at += by;
        for (Sphere& sphere : scene.spheres) {
            sphere.center0 += by;
            sphere.center1 += by;
        }
    }
    Scene scene;

  private:
    std::int32_t solid(const Vector3d& colour) {
        scene.textures.emplace_back().even = colour;
        return static_cast<std::int32_t>(scene.textures.size()) - 1;
    }
    std::int32_t add(const Material& material) {
        scene.materials.push_back(material);
        return static_cast<std::int32_t>(scene.materials.size()) - 1;
    }
};

/// Balls on a ground sphere, 20 000 units from the origin.
Scene far_scene() {
    Builder b(40);
    const auto ground = b.diffuse(Vector3d(0.6, 0.62, 0.55));
    const auto red = b.diffuse(Vector3d(0.8, 0.35, 0.3));
    const auto white = b.diffuse(Vector3d(0.85, 0.85, 0.85));
    b.sphere({0, -1000, 0}, 1000, ground);
    b.sphere({-1.1, 1, 0}, 1, red);
    b.sphere({1.1, 1, 0.2}, 1, white);
    b.sphere({0.1, 0.4, 1.4}, 0.4, white);
    b.look({0, 1.6, 6}, {0, 0.8, 0});
    b.move(Vector3d(13'337, 9'001, 12'007));
    return b.scene;
}

/// Balls of half a thousandth on a floor.
Scene tiny_scene() {
    constexpr double kRadius = 5e-4;
    Builder b(30);
    const auto floor = b.diffuse(Vector3d(0.75, 0.75, 0.72));
    const auto red = b.diffuse(Vector3d(0.8, 0.35, 0.3));
    const auto blue = b.diffuse(Vector3d(0.3, 0.45, 0.8));
    for (int i = -2; i <= 2; ++i)
        for (int k = -1; k <= 1; ++k)
            b.sphere({2.6 * i * kRadius, kRadius, 2.6 * k * kRadius}, kRadius, (i + k) % 2 == 0 ? red : blue);
    b.scene.quads.push_back({{-0.05, 0, -0.05}, {0, 0, 0.1}, {0.1, 0, 0}, floor});
    b.look({0.0006, 0.0026, 0.0062}, {0, 0.0003, 0});
    return b.scene;
}

/// Glass of four ten-thousandths before a checker.
Scene glass_scene() {
    constexpr double kRadius = 4e-4;
    Builder b(40);
    const auto wall = b.checker(2.5e-4, {0, 0, 0.9e-4});
    const auto glass = b.glass();
    for (int i = -1; i <= 1; ++i) b.sphere({2.3 * i * kRadius, 0, 0}, kRadius, glass);
    b.scene.quads.push_back({{-0.02, -0.02, -0.0012}, {0.04, 0, 0}, {0, 0.04, 0}, wall});
    b.look({0, 0.0003, 0.0035}, {0, 0, 0});
    return b.scene;
}

/// A ground of four million units.
Scene huge_scene() {
    Builder b(40);
    const auto ground = b.checker(1, {0.1, 0.5, 0.1});
    const auto red = b.diffuse(Vector3d(0.8, 0.35, 0.3));
    const auto white = b.diffuse(Vector3d(0.85, 0.85, 0.85));
    b.sphere({0, -4e6, 0}, 4e6, ground);
    b.sphere({-1.2, 0.6, 0}, 0.6, red);
    b.sphere({0.6, 0.5, 1}, 0.5, white);
    b.look({1, 2, 7}, {0, 0.4, 0});
    return b.scene;
}

/// A slope, a rug of the same colour in it, and balls on it that are listed twice.
Scene coincident_scene() {
    Builder b(36);
    const auto floor = b.diffuse(Vector3d(0.75, 0.75, 0.72));
    const auto red = b.diffuse(Vector3d(0.8, 0.35, 0.3));
    const auto glass = b.glass();
    const Vector3d u = Vector3d(0.96, 0.28, 0.03).normalized();
    const Vector3d n = Vector3d(-0.27, 0.93, 0.21).cross(u).cross(u).normalized() * -1;
    const Vector3d v = n.cross(u);
    b.scene.quads.push_back({-6 * u - 6 * v, 12 * v, 12 * u, floor});
    b.scene.quads.push_back({-1.9 * u - 0.2 * v, 1.7 * u + 0.5 * v, 1.3 * v - 0.4 * u, floor});
    for (int i = 0; i < 2; ++i) {
        b.sphere(0.9 * u - 0.3 * v + 0.7 * n, 0.7, red);
        b.sphere(0.3 * u + 1.4 * v + 0.45 * n, 0.45, glass);
    }
    b.look({0.5, 2.6, 5.2}, {0.1, 0.3, 0});
    return b.scene;
}

/// A floor around the origin.
Scene checker_scene() {
    Builder b(40);
    const auto floor = b.checker(0.5, {0, 0.25, 0});
    b.sphere({0, 0.3, 0}, 0.3, b.diffuse(Vector3d(0.8, 0.35, 0.3)));
    b.scene.quads.push_back({{-20, 0, -20}, {0, 0, 40}, {40, 0, 0}, floor});
    b.look({0.7, 3, 4.2}, {0, 0, 0});
    return b.scene;
}

Image render(const Scene& scene, const RenderSettings& settings, const auto& render_into, double max_radiance) {
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(settings.end_sample, max_radiance));
    render_into(framebuffer);
    return framebuffer.image(settings.end_sample);
}

}  // namespace

const std::vector<Failure>& all_failures() {
    static const std::vector<Failure> kFailures{{"acne", "2a", NaiveVariant::LeastDistance, far_scene()},
                                                {"leak", "2c", NaiveVariant::LeastDistance, tiny_scene()},
                                                {"glass", "2b", NaiveVariant::LeastDistance, glass_scene()},
                                                {"coincidence", "2f", NaiveVariant::IdAlone, coincident_scene()},
                                                {"ground", "1c", NaiveVariant::HalfB, huge_scene()},
                                                {"checker", "8a", NaiveVariant::Truncation, checker_scene()}};
    return kFailures;
}

FailureImages render_failure(NaiveVariant variant, const Scene& scene, const RenderSettings& settings) {
    const CompiledScene<float> narrow = compile<float>(scene);
    const CompiledScene<double> wide = compile<double>(scene);
    const bool is_id_alone = variant == NaiveVariant::IdAlone;
    const CompiledScene<float> naive = is_id_alone ? compile<float>(scene, no_coincidence(scene)) : narrow;
    const recursive::IterativeEngine engine;
    const double most = narrow.max_radiance;
    return {render(
                scene, settings, [&](Framebuffer& f) { render_naively(variant, naive, settings, f); }, most),
            render(
                scene, settings, [&](Framebuffer& f) { engine.render(narrow, settings, f); }, most),
            render(
                scene, settings, [&](Framebuffer& f) { engine.render(wide, settings, f); }, most)};
}

double changed_share(const Image& image, const Image& reference) {
    std::int64_t changed = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        bool is_changed = false;
        for (std::size_t k = i; k < i + 3; ++k)
            is_changed = is_changed || std::fabs(image.rgb[k] - reference.rgb[k]) > 0.02F;
        changed += is_changed ? 1 : 0;
    }
    return 3 * static_cast<double>(changed) / static_cast<double>(image.rgb.size());
}

}  // namespace raypool::stability
