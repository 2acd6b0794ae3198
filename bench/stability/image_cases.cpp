// Row 2e, and one that was added: whole images by the engine, their mean held against double with the same samples.

#include <cmath>
#include <numeric>

#include "bench/stability/case.h"
#include "bench/stability/failures.h"
#include "bench/stability/methods.h"
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

constexpr auto kNaive = [](const FailureImages& images) { return images.naive; };
constexpr auto kOurs = [](const FailureImages& images) { return images.ours; };

template <class Image>
double bias(const Image& image_of, const Scene& scene, std::int64_t spp) {
    RenderSettings settings;
    settings.end_sample = spp;
    const FailureImages images = render_failure(NaiveVariant::LeastDistance, scene, settings);
    return std::abs(mean(image_of(images)) / mean(images.reference) - 1);
}
constexpr auto kBiasByRadius = []<class>(const auto& image_of, double radius, std::int64_t spp) {
    return bias(image_of, ball_on_ground(radius, 0), spp);
};
constexpr auto kBiasByTranslation = []<class>(const auto& image_of, double translation, std::int64_t spp) {
    return bias(image_of, ball_on_ground(1000, translation), spp);
};

}  // namespace

CaseMethods image_cases() {
    return {
        {"ground-bias", Methods(kBiasByRadius).naive("least distance 1e-3, float", kNaive).ours("ours, float", kOurs)},
        {"far-scene-bias",
         Methods(kBiasByTranslation).naive("least distance 1e-3, float", kNaive).ours("ours, float", kOurs)}};
}

}  // namespace raypool::stability
