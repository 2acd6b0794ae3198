/// Small renders for tests of whole images: the committed scenes at a size of choice, their sums and their hash.
///
/// Called by tests/equivalence/ and tests/physics/.
#pragma once

#include <algorithm>
#include <string>

#include "core/runtime/engine.h"
#include "core/scene/scene_reader.h"
#include "recursive/engine.h"

namespace raypool {

/// A built-in scene, or `textures`, `sky_image`, `instances`, `solids` or `smooth`, at another width, in its own shape
/// unless a height is given.
inline Scene small_scene(const std::string& name, std::int64_t width, std::int64_t height = 0) {
    const char* const folder = name == "textures" || name == "sky_image"                     ? "textures/"
                               : name == "instances" || name == "solids" || name == "smooth" ? "meshes/"
                                                                                             : nullptr;
    Scene scene = folder == nullptr ? builtin_scene(name)
                                    : read_scene(RAYPOOL_SOURCE_DIR "/scenes/" + std::string(folder) + name + ".json");
    scene.height = height > 0 ? height : std::max<std::int64_t>(1, scene.height * width / scene.width);
    scene.width = width;
    return scene;
}

struct Rendered {
    Framebuffer framebuffer;
    RenderReport report;
    std::int64_t sample_count;

    [[nodiscard]] std::string hash() const { return framebuffer.hash(); }
    [[nodiscard]] Image image() const { return framebuffer.image(sample_count); }
    /// Mean over all pixels and samples, from the exact sums.
    [[nodiscard]] double mean(int channel) const {
        double sum = 0;
        for (std::int64_t pixel = 0; pixel < framebuffer.width() * framebuffer.height(); ++pixel)
            sum += static_cast<double>(framebuffer.sums()[static_cast<std::size_t>(3 * pixel + channel)]);
        const auto samples = static_cast<double>(sample_count * framebuffer.width() * framebuffer.height());
        return sum / framebuffer.fixed_point().scale() / samples;
    }
};

/// Renders into an empty framebuffer with `render_into(framebuffer)`, which returns a RenderReport.
template <class Scalar, class RenderInto>
Rendered rendered_by(const CompiledScene<Scalar>& scene, const RenderSettings& settings, RenderInto render_into) {
    Rendered out{Framebuffer(scene.width, scene.height, fixed_point(scene, settings, settings.end_sample)),
                 {},
                 settings.end_sample - settings.first_sample};
    out.report = render_into(out.framebuffer);
    return out;
}

template <class Scalar>
Rendered render(const Engine& engine, const CompiledScene<Scalar>& scene, const RenderSettings& settings) {
    return rendered_by(scene, settings,
                       [&](Framebuffer& framebuffer) { return engine.render(scene, settings, framebuffer); });
}

/// By the iterative engine, in one thread.
template <class Scalar>
Rendered render(const Scene& scene, std::int64_t spp, std::int32_t depth, int split_depth = 0) {
    RenderSettings settings;
    settings.end_sample = spp;
    settings.depth = depth;
    settings.split_depth = split_depth;
    return render(recursive::IterativeEngine(), compile<Scalar>(scene), settings);
}

}  // namespace raypool
