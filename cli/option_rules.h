/// Which options go together. One that would do nothing beside what else was chosen is refused, rather than taken in
/// silence and put on record: one table for all commands.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace raypool::cli {

/// Refuses (InputError, naming both) the first option of the command, in the order of the table, that was given where
/// it does nothing.
void check_option_rules(const CLI::App& command);

/// The engine that `render` uses: the one that was asked for, else the fastest, which is not for --cost-image.
std::string engine_in_effect(const CLI::App& render_command);

}  // namespace raypool::cli
