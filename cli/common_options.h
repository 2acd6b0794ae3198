/// The options of every command that renders one scene by its user's settings: what the image depends on, and the order
/// of the work.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/runtime/settings.h"
#include "core/scene/scene.h"

namespace raypool::cli {

/// As they are given.
struct CommonOptions {
    std::string scene = "paper";
    std::int64_t width = 0;   ///< 0: the scene's
    std::int64_t height = 0;  ///< 0: follows from the width
    std::int64_t depth = 50;
    int split_depth = 0;
    std::string seed = "0";
    std::string sampler = "independent";
    bool roulette = false;
    std::string light_sampling = "mis";  ///< where the scene has lights
    int threads = 0;  ///< 0: OpenMP's
    std::optional<std::string> schedule;
    std::optional<std::string> grain;
};

void add_common_options(CLI::App& command, CommonOptions& options);

/// All of them but the schedule, which not every engine has. Samples are still to be set. Refuses (InputError) texts
/// that make no sense.
RenderSettings common_settings(const CommonOptions& options);

/// At the size that is asked for.
Scene scene_of(const CommonOptions& options);

}  // namespace raypool::cli
