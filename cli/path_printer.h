/// The debugger of a path tracer: the paths of pixels, vertex by vertex, on the standard output.
#pragma once

#include "cli/stats_json.h"
#include "core/film/framebuffer.h"
#include "core/scene/scene.h"
#include "core/shading/compiled_scene.h"

namespace raypool::cli {

/// Follows the paths of the pixels and samples of `record` once more, by one thread, and prints where each meets what,
/// with which throughput it goes on and what it brings home. Without splitting, in single precision. Throws
/// std::runtime_error if what the paths bring home is not, to the bit, what `rendered` has in these pixels.
void print_paths(const Scene& scene, const CompiledScene<float>& compiled, const RenderRecord& record,
                 const Framebuffer& rendered);

}  // namespace raypool::cli
