/// From a scene to the image and the record of its making, by way of sums that may come from, and go to, a checkpoint.
#pragma once

#include "cli/checkpoint_keeper.h"
#include "cli/render_options.h"
#include "cli/render_record.h"
#include "cluster/ranks.h"
#include "core/image/image_file.h"
#include "core/scene/scene.h"

namespace raypool::cli {

/// All that fixes the image, of what `record` has before a render. Threads, engine and pool do not. Checkpoints, parts
/// and ranks must have it in common.
ImageKey image_key(const Scene& scene, const RenderRecord& record);

/// Renders what the checkpoint, if one is resumed, lacks. Reads the settings in `record`, and fills in
/// what was made. Where the checkpoint was asked to stop, the image is of the samples so far. Of several ranks, all
/// call it, and rank 0 gets the image; what others get means nothing.
RenderedImage render_image(const Scene& scene, const RenderOptions& options, CheckpointKeeper& checkpoint,
                           cluster::Ranks& ranks, RenderRecord& record);

}  // namespace raypool::cli
