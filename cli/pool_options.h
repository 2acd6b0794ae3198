/// The options of the wavefront engine, on the command line and in records.
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "wavefront/settings.h"

namespace raypool::cli {

/// What was asked for; a word that is empty, or a number that is 0, means the default.
struct PoolOptions {
    std::string scope;
    std::string refill;
    std::string width;
    std::string intersection;
    std::string camera;
    std::string sort;
    std::string append;
    std::string accumulator;
    std::int64_t rays = 0;
    std::int64_t batch = 0;
};

void add_pool_options(CLI::App& command, PoolOptions& options);

/// Defaults filled in. What is best for a shared pool differs from what is best for per-thread ones.
wavefront::PoolSettings pool_settings(const PoolOptions& options);

nlohmann::json to_json(const wavefront::PoolSettings& settings);

}  // namespace raypool::cli
