/// What a study found, as JSON and as a page to read.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "bench/studies/study.h"

namespace raypool::studies {

/// "holds", "does not hold", "cannot be told here".
const char* to_string(Verdict verdict);

/// Adds findings, pictures, tables and notes to the JSON of a run.
void add_summary(nlohmann::json& run, const Summary& summary);

/// A table in Markdown.
std::string markdown(const nlohmann::json& header, const nlohmann::json& rows);

/// summary.md, from the JSON of a finished run.
std::string summary_page(const nlohmann::json& run);

/// "AMD EPYC, 2 cores, gcc 12.2.0, commit 0123456789ab"
std::string machine_line(const nlohmann::json& environment);

}  // namespace raypool::studies
