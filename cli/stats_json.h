/// The JSON that `--stats` writes, and what the render command knows to put into it.
#pragma once

#include <any>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "cli/options.h"
#include "core/runtime/adaptive.h"
#include "core/runtime/engine.h"
#include "gpu/settings.h"
#include "wavefront/settings.h"

namespace raypool::cli {

/// A render from the scene file to the image file, for the record.
struct RenderRecord {
    std::string scene_name;
    Features features;
    std::int64_t width = 0;
    std::int64_t height = 0;
    PixelWindow crop;  ///< the pixels that are rendered: all, or fewer
    std::int64_t spp = 0;
    Precision precision = Precision::Float;
    std::string engine;
    RenderSettings settings;
    wavefront::PoolSettings pool;     ///< of the wavefront engine
    gpu::GpuSettings gpu;             ///< of the GPU engine
    RenderReport report;              ///< of all ranks
    std::vector<RenderReport> ranks;  ///< of each, where there are several
    bool has_aovs = false;
    double target_error = 0;          ///< 0: every pixel has the same number of samples
    AdaptiveReport adaptive;
    double sum_step = 0;          ///< of the framebuffer's sums, in radiance
    double mean_radiance = 0;     ///< of the image
    double dimmest_light = 0;     ///< of the scene
    double truncation_bound = 0;  ///< CompiledScene::truncation_bound() at the depth of the settings
    std::string hash;
    std::int64_t samples_done = 0;  ///< for each pixel, those of a resumed checkpoint too; on average where adaptive
    double read_s = 0;              ///< scene file to description
    double compile_s = 0;           ///< description to tables
    double aovs_s = 0;              ///< first hits, and what halves tell
    double write_s = 0;             ///< sums to image file
    double total_s = 0;
};

/// Whether fewer pixels are rendered than the image has.
bool is_cropped(const RenderRecord& record);

/// The settings of its own that the engine takes.
std::any engine_options(const RenderRecord& record);

/// Whether the engine hands out parts of the image, so that the schedule has an effect.
bool loops_over_image(const RenderRecord& record);

/// Whether an adaptive render ended without the error that was asked for, which is not what its user wanted.
bool misses_target(const RenderRecord& record);

/// What has an effect.
nlohmann::json settings_json(const RenderRecord& record);
nlohmann::json stats_json(const RenderRecord& record);

}  // namespace raypool::cli
