#include "bench/stability/failures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>

#include "bench/stability/around.h"
#include "bench/stability/case.h"
#include "bench/stability/failures_json.h"
#include "bench/stability/methods.h"
#include "core/base/error.h"
#include "core/scene/scene_parser.h"
#include "recursive/engine.h"

namespace raypool::stability {

namespace {

/// In the order of NaiveVariant.
constexpr const char* kVariantNames[] = {"least distance",   "half-b",           "truncation", "id alone",
                                         "whole shadow ray", "short shadow ray", "no sine"};

NaiveVariant variant_named(const std::string& name) {
    const auto* const found = std::find(std::begin(kVariantNames), std::end(kVariantNames), name);
    RAYPOOL_CHECK(found != std::end(kVariantNames), "failures.json names a variant that there is");
    return static_cast<NaiveVariant>(found - std::begin(kVariantNames));
}

Scene scene_of(const nlohmann::json& entry) {
    Scene scene = parse_scene(entry.at("scene").dump(), "bench/stability/failures.json", {});
    if (entry.contains("sky")) {
        const nlohmann::json& sky = entry.at("sky");
        scene.background.image = around<float>(sky.at("rows"), [&](std::int64_t column, std::int64_t row) {
                                     const bool is_sun = column == sky.at("sun_column") && row == sky.at("sun_row");
                                     return sky.at(is_sun ? "sun" : "radiance").get<double>();
                                 }).image;
    }
    return scene;
}

}  // namespace

const std::vector<Failure>& all_failures() {
    static const std::vector<Failure> kFailures = [] {
        std::vector<Failure> all;
        for (const nlohmann::json& entry : nlohmann::json::parse(kFailuresJson))
            all.push_back({entry.at("id"), entry.at("row"), variant_named(entry.at("variant")), scene_of(entry)});
        return all;
    }();
    return kFailures;
}

FailureImages render_failure(NaiveVariant variant, const Scene& scene, RenderSettings settings) {
    settings.light_sampling = LightSampling::Light;
    const CompiledScene<float> narrow = compile<float>(scene);
    const CompiledScene<double> wide = compile<double>(scene);
    const recursive::IterativeEngine engine;
    const auto image = [&](const auto& render) {
        Framebuffer framebuffer(scene.width, scene.height, fixed_point(narrow, settings, settings.end_sample));
        render(framebuffer);
        return framebuffer.image(settings.end_sample);
    };
    return {image([&](Framebuffer& f) { render_naively(variant, scene, settings, f); }),
            image([&](Framebuffer& f) { engine.render(narrow, settings, f); }),
            image([&](Framebuffer& f) { engine.render(wide, settings, f); })};
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

// Row 2e, and one that was added: whole images by the engine, their mean held against double with the same samples.

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

double bias(Image FailureImages::*image, const Scene& scene, std::int64_t spp) {
    RenderSettings settings;
    settings.end_sample = spp;
    const FailureImages images = render_failure(NaiveVariant::LeastDistance, scene, settings);
    return std::abs(mean(images.*image) / mean(images.reference) - 1);
}
constexpr auto kBiasByRadius = []<class>(Image FailureImages::*image, double radius, std::int64_t spp) {
    return bias(image, ball_on_ground(radius, 0), spp);
};
constexpr auto kBiasByTranslation = []<class>(Image FailureImages::*image, double translation, std::int64_t spp) {
    return bias(image, ball_on_ground(1000, translation), spp);
};

}  // namespace

CaseMethods image_cases() {
    return {{"ground-bias", Methods(kBiasByRadius)
                                .naive("least distance 1e-3, float", &FailureImages::naive)
                                .ours("ours, float", &FailureImages::ours)},
            {"far-scene-bias", Methods(kBiasByTranslation)
                                   .naive("least distance 1e-3, float", &FailureImages::naive)
                                   .ours("ours, float", &FailureImages::ours)}};
}

}  // namespace raypool::stability
