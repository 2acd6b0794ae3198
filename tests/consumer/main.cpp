// Renders a built-in scene with the installed library and prints the hash of the image.
#include <cstdio>
#include <string>

#include "core/film/framebuffer.h"
#include "core/runtime/engine.h"
#include "core/scene/scene_reader.h"
#include "core/shading/compiled_scene.h"
#include "recursive/engine.h"

int main() {
    raypool::Scene scene = raypool::load_scene("one_sphere");
    scene.width = 32;
    scene.height = 18;
    const auto compiled = raypool::compile<float>(scene);

    raypool::RenderSettings settings;
    settings.end_sample = 4;
    raypool::Framebuffer framebuffer(scene.width, scene.height,
                                     raypool::FixedPoint::make(settings.end_sample, compiled.max_radiance));
    const raypool::recursive::RecursiveEngine engine;
    const raypool::RenderReport report = engine.render(compiled, settings, framebuffer);

    const std::string hash = framebuffer.hash();
    std::printf("%s: %lld paths, hash %s\n", scene.name.c_str(), static_cast<long long>(report.paths()), hash.c_str());
    return hash.empty() || report.paths() != 32 * 18 * 4 ? 1 : 0;
}
