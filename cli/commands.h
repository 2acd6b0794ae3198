/// The sub-commands of `raypool`: each adds its options to the parser, and what it does when it is the one called.
///
/// A command returns its exit status through `status`: 0 done, 1 failed or differs. Bad input is an InputError.
#pragma once

#include <CLI/CLI.hpp>

#include "cluster/ranks.h"

namespace raypool::cli {

/// The only one that several ranks can run together.
void add_render_command(CLI::App& app, cluster::Ranks& ranks, int& status);
void add_compare_command(CLI::App& app, int& status);
void add_info_command(CLI::App& app, int& status);
void add_diff_command(CLI::App& app, int& status);
void add_merge_command(CLI::App& app, int& status);
void add_scenes_command(CLI::App& app);
void add_manual_command(CLI::App& app);  ///< of all commands that the parser has
// Where RAYPOOL_BUILD_BENCH is on.
void add_advise_command(CLI::App& app, int& status);
void add_report_command(CLI::App& app, int& status);
void add_study_command(CLI::App& app, int& status);

}  // namespace raypool::cli
