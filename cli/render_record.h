/// From options to the record of a render, and from its sums to its image: what the command and the Python module have
/// in common.
#pragma once

#include <vector>

#include "cli/render_options.h"
#include "cli/stats_json.h"
#include "core/film/framebuffer.h"
#include "core/image/image_file.h"
#include "core/scene/scene.h"
#include "core/shading/compiled_scene.h"

namespace raypool::cli {

/// What the options say without a scene. Refuses (InputError) what makes no sense.
RenderRecord start_record(const RenderOptions& options);

/// Adds what the scene says, and refuses what does not fit it, or takes more memory than is available: each of so many
/// processes on this machine has the sums and images.
void add_scene(RenderRecord& record, const Scene& scene, const RenderOptions& options, int process_count = 1);

/// Compiles the scene of a record, and adds what it then says.
template <class Scalar>
CompiledScene<Scalar> compile_for(RenderRecord& record, const Scene& scene);

/// An empty framebuffer for the render.
template <class Scalar>
Framebuffer make_sums(const RenderRecord& record, const CompiledScene<Scalar>& scene);

/// The AOVs (core/runtime/aovs.h) of sums that are all there; none where the record has none.
template <class Scalar>
std::vector<ImageChannel> make_aovs(RenderRecord& record, const CompiledScene<Scalar>& compiled,
                                    const Framebuffer& sums);

/// What becomes of a render.
struct RenderedImage {
    Image image;
    std::vector<ImageChannel> aovs;
};
/// Makes the image of what is there: record.samples_done samples, or the adaptive report's. Adds what is known of it.
RenderedImage finish_record(RenderRecord& record, const Scene& scene, Framebuffer sums, std::vector<ImageChannel> aovs);

}  // namespace raypool::cli
