#include "bench/accuracy/configuration.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/runtime/settings_text.h"
#include "recursive/engine.h"
#include "wavefront/engine.h"

namespace raypool::accuracy {

namespace {

constexpr int kDepths[] = {3, 5, 8, 12, 20, 50, 200};

/// What `visit` makes of the scene in the configuration's precision.
auto in_precision(const Configuration& configuration, const SceneInBoth& scene, const auto& visit) {
    return configuration.precision == Precision::Float ? visit(scene.in_float) : visit(scene.in_double);
}

}  // namespace

std::string to_string(const Configuration& c) {
    std::string text = fmt::format("{} {}", c.precision == Precision::Float ? "float" : "double",
                                   c.engine == EngineKind::Pool ? "pool" : "recursion");
    if (c.sampler == Sampler::Sobol) text += ", Sobol";
    if (c.roulette) text += ", roulette";
    if (c.depth != Configuration{}.depth) text += fmt::format(", depth {}", c.depth);
    if (c.split_depth != 0) text += fmt::format(", split {}", c.split_depth);
    if (c.light_sampling != LightSampling::None) text += fmt::format(", {}", raypool::to_string(c.light_sampling));
    return text;
}

std::string render_flags(const Configuration& c, const Features& scene) {
    return fmt::format("--engine {} --precision {} --sampler {}{} --depth {}{}{}",
                       c.engine == EngineKind::Pool ? "wavefront" : "recursive",
                       c.precision == Precision::Float ? "float" : "double",
                       c.sampler == Sampler::Sobol ? "sobol" : "independent", c.roulette ? " --roulette" : "", c.depth,
                       c.split_depth == 0 ? "" : fmt::format(" --split-depth {}", c.split_depth),
                       scene.lights ? fmt::format(" --light-sampling {}", raypool::to_string(c.light_sampling)) : "");
}

ImageSettings image_settings(const Configuration& c, std::uint64_t seed) {
    return {c.depth, seed, c.sampler, c.split_depth, c.roulette, c.light_sampling};
}

RenderReport render_into(Framebuffer& framebuffer, const Configuration& configuration, const SceneInBoth& scene,
                         const Taken& taken) {
    RenderSettings settings{image_settings(configuration, taken.seed), {taken.threads, {}, {}}, {}};
    settings.first_sample = taken.first_sample;
    settings.end_sample = taken.end_sample;
    return in_precision(configuration, scene, [&](const auto& compiled) {
        return configuration.engine == EngineKind::Pool
                   ? wavefront::WavefrontEngine({}).render(compiled, settings, framebuffer)
                   : recursive::RecursiveEngine().render(compiled, settings, framebuffer);
    });
}

TimedImage render_image(const Configuration& configuration, const SceneInBoth& scene, const Taken& taken) {
    Framebuffer framebuffer(scene.in_float.width, scene.in_float.height,
                            fixed_point(configuration, scene, taken.end_sample));
    RenderReport report = render_into(framebuffer, configuration, scene, taken);
    return {channel_means(framebuffer, taken.end_sample - taken.first_sample), std::move(report), framebuffer.hash()};
}

FixedPoint fixed_point(const Configuration& configuration, const SceneInBoth& scene, std::int64_t spp) {
    return in_precision(configuration, scene, [&](const auto& compiled) {
        return raypool::fixed_point(compiled, image_settings(configuration, 0), spp);
    });
}

Values channel_means(const Framebuffer& framebuffer, std::int64_t sample_count) {
    Values values(framebuffer.sums().size());
    const double scale = 1 / (framebuffer.fixed_point().scale() * static_cast<double>(sample_count));
    std::transform(framebuffer.sums().begin(), framebuffer.sums().end(), values.begin(),
                   [scale](std::int64_t sum) { return static_cast<double>(sum) * scale; });
    return values;
}

Configuration trusted_for(const CompiledScene<double>& scene) {
    constexpr double kNothing = 1e-12;
    Configuration trusted = kTrusted;
    const double deepest = std::ceil(std::log(kNothing) / std::log(std::min(scene.max_albedo, 1 - 1e-9)));
    trusted.depth = static_cast<std::int32_t>(std::clamp<double>(deepest, kDepths[0], kDeep));
    return trusted;
}

Configuration reference_configuration(const SceneInBoth& scene) {
    Configuration reference = kTrusted;
    if (scene.in_double.features.lights) reference.light_sampling = LightSampling::Mis;
    return reference;
}

std::vector<Change> changes(const Features& scene, const Configuration& trusted) {
    std::vector<Change> all{
        {"float instead of double", Group::Precision, [](Configuration& c) { c.precision = Precision::Float; }},
        {"recursion instead of the pool", Group::Engine, [](Configuration& c) { c.engine = EngineKind::Recursive; }}};
    for (const int depth : kDepths)
        if (depth < trusted.depth)
            all.push_back({fmt::format("depth {} instead of {}", depth, trusted.depth), Group::Depth,
                           [=](Configuration& c) { c.depth = depth; }});
    all.push_back({"Sobol points instead of independent ones", Group::Sampler,
                   [](Configuration& c) { c.sampler = Sampler::Sobol; }});
    all.push_back({"roulette", Group::Roulette, [](Configuration& c) { c.roulette = true; }});
    for (int split = 1; scene.dielectric && split <= 2; ++split)
        all.push_back({fmt::format("both branches of the first {} hit{} on glass", split, split == 1 ? "" : "s"),
                       Group::Split, [=](Configuration& c) { c.split_depth = split; }});
    if (scene.lights)
        all.push_back({"lights sampled (mis), not left to chance", Group::Lights,
                       [](Configuration& c) { c.light_sampling = LightSampling::Mis; }});
    return all;
}

}  // namespace raypool::accuracy
