// Renders a built-in scene with the installed library, once more by the GPU engine's bodies, and prints the hash of the
// image.
#include <cstdio>
#include <string>

#include "core/film/framebuffer.h"
#include "core/runtime/engine.h"
#include "core/scene/scene_reader.h"
#include "core/shading/compiled_scene.h"
#include "gpu/engine.h"
#include "gpu/host_device.h"
#include "recursive/engine.h"

int main() {
    raypool::Scene scene = raypool::load_scene("one_sphere");
    scene.width = 32;
    scene.height = 18;
    const auto compiled = raypool::compile<float>(scene);

    raypool::RenderSettings settings;
    settings.end_sample = 4;
    const auto hash_by = [&](const raypool::Engine& engine) {
        raypool::Framebuffer framebuffer(scene.width, scene.height,
                                         raypool::FixedPoint::make(settings.end_sample, compiled.max_radiance));
        const raypool::RenderReport report = engine.render(compiled, settings, framebuffer);
        return report.paths() == 32 * 18 * 4 ? framebuffer.hash() : std::string();
    };
    const std::string hash = hash_by(raypool::recursive::RecursiveEngine());
    std::printf("%s: hash %s\n", scene.name.c_str(), hash.c_str());
    const raypool::gpu::GpuEngine gpu({}, raypool::gpu::host_device);
    return !hash.empty() && hash_by(gpu) == hash ? 0 : 1;
}
