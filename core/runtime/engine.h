/// What every engine is asked: RenderSettings, RenderSession, Engine. What it answers is in report.h.
///
/// An engine owns the order of the work and nothing else; all physics is in core/. For one scene, precision, seed,
/// depth and sample range, every engine and every setting of the loop makes the same sums.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/film/framebuffer.h"
#include "core/math/flush_denormals.h"
#include "core/runtime/report.h"
#include "core/runtime/settings.h"
#include "core/shading/compiled_scene.h"

namespace raypool {

/// What is rendered at a time: samples [first_sample, end_sample) of some pixels, in rising order; of all where null.
struct RenderUnit {
    std::int64_t first_sample = 0;
    std::int64_t end_sample = 0;
    const std::vector<std::uint32_t>* pixels = nullptr;
};

/// A render in units: pieces between checkpoints, a rank's share, passes of an adaptive render. It holds what is set up
/// once for all of them: pools, the stages' memory, accumulators. What it was made of outlives it; for one thread.
class RenderSession {
  public:
    RenderSession() = default;
    RenderSession(const RenderSession&) = delete;
    RenderSession& operator=(const RenderSession&) = delete;
    virtual ~RenderSession() = default;

    /// Renders the unit. Its samples are in the framebuffer, or kept until merge(). Returns what this unit took.
    RenderReport add(const RenderUnit& unit) {
        RenderReport part = render(unit);
        report_.add(part);
        return part;
    }
    /// Brings all that was added into the framebuffer. More may be added afterwards. Returns what it took.
    RenderReport merge() {
        RenderReport part = collect();
        report_.add(part);
        return part;
    }
    /// Of the setup, and all that was added and merged.
    [[nodiscard]] const RenderReport& report() const { return report_; }
    /// Merges, and gives the report away: nothing may be added afterwards.
    RenderReport finish() {
        merge();
        return std::move(report_);
    }

  protected:
    virtual RenderReport render(const RenderUnit& unit) = 0;
    virtual RenderReport collect() { return {}; }

    RenderReport report_;
};

/// Renders the samples and pixels of `settings`, the only unit of its session.
RenderReport render_whole(RenderSession& session, const RenderSettings& settings);

/// Says that the build has no double precision (RAYPOOL_BUILD_DOUBLE): what engines do then in place of begin().
[[noreturn]] void refuse_double();

class Engine {
  public:
    Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;
    virtual ~Engine() = default;

    [[nodiscard]] virtual std::string name() const = 0;
    /// Whether threads get parts of the image, as RenderSettings::schedule and grain say. Where not, the two do
    /// nothing.
    [[nodiscard]] virtual bool loops_over_image() const { return true; }

    /// Begins a render into the framebuffer, which has the scene's size. Of the settings, the samples and pixels are
    /// left to the units. Throws InputError for settings that this engine cannot carry out on this machine, and for
    /// pools and accumulators that do not fit into its memory; the framebuffer is then untouched.
    [[nodiscard]] virtual std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene,
                                                               const RenderSettings& settings,
                                                               Framebuffer& framebuffer) const = 0;
    [[nodiscard]] virtual std::unique_ptr<RenderSession> begin(const CompiledScene<double>& scene,
                                                               const RenderSettings& settings,
                                                               Framebuffer& framebuffer) const = 0;

    /// Adds the samples of the settings to the framebuffer.
    template <class Scalar>
    RenderReport render(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                        Framebuffer& framebuffer) const {
        return render_whole(*begin(scene, settings, framebuffer), settings);
    }
};

/// The paths that a render will follow.
template <class Scalar>
std::int64_t path_count(const SceneView<Scalar>& scene, const RenderUnit& unit) {
    const auto pixels = unit.pixels == nullptr ? scene.pixel_count() : static_cast<std::int64_t>(unit.pixels->size());
    return pixels * (unit.end_sample - unit.first_sample);
}
template <class Scalar>
std::int64_t path_count(const SceneView<Scalar>& scene, const RenderSettings& settings) {
    return path_count(scene, RenderUnit{settings.first_sample, settings.end_sample, settings.pixels});
}

/// What a render needs of kernels: the scene's features, less light sampling where the settings have none.
inline Features needed_features(const Features& scene, const ImageSettings& settings) {
    Features needed = scene;
    needed.lights = scene.lights && settings.light_sampling != LightSampling::None;
    return needed;
}

/// None where the scene has no lights.
inline LightSampling needed_light_sampling(const Features& scene, const ImageSettings& settings) {
    return scene.lights ? settings.light_sampling : LightSampling::None;
}

/// How much the parts of a sample add up to at most, beside the greatest of them: with light sampling a path brings one
/// at each hit that samples lights, and one at its end. By LightSampling::Mis none brings more than the path's
/// throughput times the scene's greatest radiance; roulette may raise throughput to 1. LightSampling::Light has no such
/// bound, nor has a split path's sum.
template <class Scalar>
double most_parts(const SceneView<Scalar>& scene, const ImageSettings& settings) {
    const LightSampling sampling = needed_light_sampling(scene.features, settings);
    if (sampling == LightSampling::None) return 1;
    const double parts = std::clamp(settings.depth, 1, kMostSampledHits + 1);
    if (sampling == LightSampling::Light) return std::ldexp(parts, settings.split_depth);
    const double albedo = scene.max_sampled_albedo;
    return settings.roulette || albedo >= 1 ? parts : (1 - std::pow(albedo, parts)) / (1 - albedo);
}

/// For up to `spp` samples a pixel of a render. Parts by LightSampling::Light are cut where they are as much as a whole
/// sample may be by Mis.
template <class Scalar>
FixedPoint fixed_point(const SceneView<Scalar>& scene, const ImageSettings& settings, std::int64_t spp) {
    const bool is_cut = needed_light_sampling(scene.features, settings) == LightSampling::Light;
    const double brightest_part = is_cut ? std::clamp(settings.depth, 1, kMostSampledHits + 1) : 1;
    return FixedPoint::make(spp, scene.max_radiance * brightest_part, most_parts(scene, settings));
}

/// No sample carries more to the image in any channel, all of its parts together.
template <class Scalar>
double greatest_sample(const SceneView<Scalar>& scene, const ImageSettings& settings) {
    const bool is_cut = needed_light_sampling(scene.features, settings) == LightSampling::Light;
    const double greatest_part = is_cut ? fixed_point(scene, settings, 1).limit : scene.max_radiance;
    return greatest_part * most_parts(scene, settings);
}

}  // namespace raypool
