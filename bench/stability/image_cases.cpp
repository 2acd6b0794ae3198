// Row 2e, and one that was added: whole images by the engine, their mean held against double with the same samples.

#include <cmath>
#include <numeric>

#include "bench/stability/case.h"
#include "bench/stability/failures.h"
#include "recursive/engine.h"

namespace raypool::stability {

namespace {

/// A ball on a ground sphere of that radius under a white sky, everything that far from the origin.
Scene ball_on_ground(double radius, double translation) {
    Scene scene;
    scene.width = 48;
    scene.height = 32;
    scene.background = {Vector3d::Ones(), Vector3d::Ones()};
    scene.textures.emplace_back().even = Vector3d::Constant(0.73);
    scene.materials.emplace_back();
    const Vector3d at = translation * Vector3d(0.6, 0.48, 0.64);
    const auto add = [&](const Vector3d& center, double r) {
        scene.spheres.push_back({at + center, at + center, r, 0});
    };
    add({0, -radius, 0}, radius);
    add({0, 1, 0}, 1);
    scene.camera.look_from = at + Vector3d(0, 1.5, 6);
    scene.camera.look_at = at + Vector3d(0, 0.8, 0);
    return scene;
}

double mean(const Image& image) {
    return std::accumulate(image.rgb.begin(), image.rgb.end(), 0.0) / static_cast<double>(image.rgb.size());
}

template <bool is_ours>
double bias(const Scene& scene, std::int64_t spp) {
    RenderSettings settings;
    settings.end_sample = spp;
    const FailureImages images = render_failure(NaiveVariant::LeastDistance, scene, settings);
    return std::abs(mean(is_ours ? images.ours : images.naive) / mean(images.reference) - 1);
}
template <bool is_ours>
double bias_by_radius(double radius, std::int64_t spp) {
    return bias<is_ours>(ball_on_ground(radius, 0), spp);
}
template <bool is_ours>
double bias_by_translation(double translation, std::int64_t spp) {
    return bias<is_ours>(ball_on_ground(1000, translation), spp);
}

}  // namespace

std::vector<Case> image_cases() {
    std::vector<Case> cases;
    cases.push_back({.id = "ground-bias",
                     .row = "2e",
                     .parameter = "radius of the ground",
                     .values = {1e1, 1e2, 1e3, 1e4},
                     .measure = "mean of the image against double, relative",
                     .tolerance = 2e-5,
                     .symptom = "everything is a little too dark",
                     .samples = 160,
                     .methods = {{"least distance 1e-3, float", Kind::Naive, bias_by_radius<false>},
                                 {"ours, float", Kind::Ours, bias_by_radius<true>}}});
    cases.push_back({.id = "far-scene-bias",
                     .row = "+",
                     .parameter = "distance of the scene from the origin",
                     .values = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5},
                     .measure = "mean of the image against double, relative",
                     .tolerance = 1e-3,
                     .symptom = "the image darkens, then falls apart, with the distance",
                     .samples = 160,
                     .methods = {{"least distance 1e-3, float", Kind::Naive, bias_by_translation<false>},
                                 {"ours, float", Kind::Ours, bias_by_translation<true>}}});
    return cases;
}

}  // namespace raypool::stability
