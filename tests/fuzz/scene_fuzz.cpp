/// Any text as a scene: it is refused by an InputError, or parses, compiles and renders a few paths that are finite.

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "core/base/error.h"
#include "core/scene/scene_parser.h"
#include "core/shading/compiled_scene.h"
#include "recursive/engine.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace raypool;

template <class Scalar>
void render_a_little(Scene scene) {
    compile<Scalar>(scene);
    constexpr std::int64_t kSide = 4;
    scene.width = std::min(scene.width, kSide);
    scene.height = std::min(scene.height, kSide);
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    RenderSettings settings;
    settings.depth = 4;
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(settings.end_sample, compiled.max_radiance));
    const RenderReport report = recursive::IterativeEngine().render(compiled, settings, framebuffer);
    require(report.statistics.non_finite == 0, "a scene within its ranges has finite samples");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const Scene scene = parse_scene(text, "fuzz.json", RAYPOOL_SOURCE_DIR "/tests/fuzz/images");
        render_a_little<float>(scene);
        render_a_little<double>(scene);
    } catch (const InputError& refusal) {
        require_one_line(refusal.what());
    }
    return 0;
}
