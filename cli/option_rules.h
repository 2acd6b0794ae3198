/// Which options go together. One that would do nothing beside what else was chosen is refused, rather than taken in
/// silence and put on record: one table for all commands.
#pragma once

#include <CLI/CLI.hpp>

namespace raypool::cli {

/// Refuses (InputError, naming both) the first option of the command, in the order of the table, that was given where
/// it does nothing.
void check_option_rules(const CLI::App& command);

}  // namespace raypool::cli
