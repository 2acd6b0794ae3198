/// The options of `render` on the command line, and the settings of a render that they make.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/checkpoint_keeper.h"
#include "cli/common_options.h"
#include "cli/pool_options.h"
#include "cli/preview.h"
#include "core/image/cost_image.h"
#include "core/runtime/settings.h"
#include "gpu/settings.h"

namespace raypool::cli {

/// As they are given; an empty name of a file means that it is not written.
struct RenderOptions : CommonOptions {
    std::string output;
    std::string stats;
    std::string status;
    std::string trace;
    std::string cost_image;
    std::string cost = "tests";
    std::string engine;  ///< empty: the fastest that can do what is asked for
    std::int64_t spp = 100;
    std::optional<std::string> samples;
    std::optional<std::string> crop;
    std::optional<std::string> pixel;
    double target_error = 0;
    std::string precision = "float";
    bool has_aovs = false;
    bool is_half = false;
    bool count_work = false;
    bool is_quiet = false;
    CheckpointOptions checkpoint;
    PreviewOptions preview;
    PoolOptions pool;
    std::string gpu_form;  ///< empty: the default
};

void add_render_options(CLI::App& command, RenderOptions& options);

/// What --cost names.
Cost cost_of(const std::string& word);

/// Refuses (InputError) texts that make no sense. Trace and cost image are still to be set.
RenderSettings render_settings(const RenderOptions& options);

/// Of the GPU engine, for records of `record_bytes`.
gpu::GpuSettings gpu_settings(const RenderOptions& options, std::size_t record_bytes);

}  // namespace raypool::cli
