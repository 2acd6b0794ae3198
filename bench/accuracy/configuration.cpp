#include "bench/accuracy/configuration.h"

#include <algorithm>

#include <fmt/format.h>

#include "recursive/engine.h"
#include "wavefront/engine.h"

namespace raypool::accuracy {

namespace {

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
    return text;
}

std::string render_flags(const Configuration& c) {
    return fmt::format("--engine {} --precision {} --sampler {}{} --depth {}{}",
                       c.engine == EngineKind::Pool ? "wavefront" : "recursive",
                       c.precision == Precision::Float ? "float" : "double",
                       c.sampler == Sampler::Sobol ? "sobol" : "independent", c.roulette ? " --roulette" : "", c.depth,
                       c.split_depth == 0 ? "" : fmt::format(" --split-depth {}", c.split_depth));
}

RenderReport render_into(Framebuffer& framebuffer, const Configuration& configuration, const SceneInBoth& scene,
                         const Taken& taken) {
    RenderSettings settings;
    settings.first_sample = taken.first_sample;
    settings.end_sample = taken.end_sample;
    settings.seed = taken.seed;
    settings.threads = taken.threads;
    settings.depth = configuration.depth;
    settings.split_depth = configuration.split_depth;
    settings.sampler = configuration.sampler;
    settings.roulette = configuration.roulette;
    return in_precision(configuration, scene, [&](const auto& compiled) {
        return configuration.engine == EngineKind::Pool
                   ? wavefront::WavefrontEngine({}).render(compiled, settings, framebuffer)
                   : recursive::RecursiveEngine().render(compiled, settings, framebuffer);
    });
}

TimedImage render_image(const Configuration& configuration, const SceneInBoth& scene, const Taken& taken) {
    const double max_radiance =
        in_precision(configuration, scene, [](const auto& compiled) -> double { return compiled.max_radiance; });
    Framebuffer framebuffer(scene.in_float.width, scene.in_float.height,
                            FixedPoint::make(taken.end_sample, max_radiance));
    RenderReport report = render_into(framebuffer, configuration, scene, taken);
    return {channel_means(framebuffer, taken.end_sample - taken.first_sample), std::move(report), framebuffer.hash()};
}

Values channel_means(const Framebuffer& framebuffer, std::int64_t sample_count) {
    Values values(framebuffer.sums().size());
    const double scale = 1 / (framebuffer.fixed_point().scale() * static_cast<double>(sample_count));
    std::transform(framebuffer.sums().begin(), framebuffer.sums().end(), values.begin(),
                   [scale](std::int64_t sum) { return static_cast<double>(sum) * scale; });
    return values;
}

}  // namespace raypool::accuracy
