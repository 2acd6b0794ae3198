#include "bench/accuracy/configuration.h"

#include <algorithm>

#include <fmt/format.h>

#include "recursive/engine.h"
#include "wavefront/engine.h"

namespace raypool::accuracy {

namespace {

RenderReport render_with(const Engine& engine, const Configuration& configuration, const SceneInBoth& scene,
                         const RenderSettings& settings, Framebuffer& framebuffer) {
    return configuration.precision == Precision::Float ? engine.render(scene.in_float, settings, framebuffer)
                                                       : engine.render(scene.in_double, settings, framebuffer);
}

double max_radiance(const Configuration& configuration, const SceneInBoth& scene) {
    return configuration.precision == Precision::Float ? scene.in_float.max_radiance : scene.in_double.max_radiance;
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
    if (configuration.engine == EngineKind::Pool)
        return render_with(wavefront::WavefrontEngine(wavefront::PoolSettings{}), configuration, scene, settings,
                           framebuffer);
    return render_with(recursive::RecursiveEngine(), configuration, scene, settings, framebuffer);
}

TimedImage render_image(const Configuration& configuration, const SceneInBoth& scene, const Taken& taken) {
    Framebuffer framebuffer(scene.in_float.width, scene.in_float.height,
                            FixedPoint::make(taken.end_sample, max_radiance(configuration, scene)));
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
