/// What the render command prints when it is done.
#pragma once

#include <string>

#include "cli/stats_json.h"

namespace raypool::cli {

void print_summary(const RenderRecord& record);

/// Says on the standard error that a --target-error was not reached, and what stopped it.
void print_miss(const RenderRecord& record);

/// What a trace file holds, and what had no room in it.
void print_trace(const std::string& file, const Trace& trace);

}  // namespace raypool::cli
