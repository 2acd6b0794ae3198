/// The options of the wavefront engine, on the command line and in records.
#pragma once

#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "wavefront/settings.h"

namespace raypool::cli {

/// What was asked for; a text that is empty, or a number that is 0, means the default.
struct PoolOptions {
    std::string scope;
    std::string refill;
    std::string width;
    std::string intersection;
    std::string camera;
    std::string sort;
    std::string append;
    std::string accumulator;
    std::string rays;  ///< a count of records, or the bytes that they may take: 512KB
    std::int64_t batch = 0;
};

void add_pool_options(CLI::App& command, PoolOptions& options);

/// Most records in a pool: a count, or as many whole records as fit into so many bytes (KB, MB or GB of 1024), one at
/// least. Refuses any other text.
std::int64_t parse_pool_rays(std::string_view text, std::size_t record_bytes);

/// Defaults filled in, for records of `record_bytes` and so many threads. What is best for a shared pool differs from
/// what is best for per-thread ones.
wavefront::PoolSettings pool_settings(const PoolOptions& options, std::size_t record_bytes, int threads);

/// What has an effect.
nlohmann::json to_json(const wavefront::PoolSettings& settings);

}  // namespace raypool::cli
