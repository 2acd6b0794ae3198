/// What rows say, in Python: scripts/analysis reads data.csv and run.json, and adds findings, tables, a page and
/// pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace raypool::studies {

/// Of a finished run: its findings into run.json, summary.md, and every picture as SVG and PNG. Needs Debian's
/// python3-matplotlib. Throws std::runtime_error, in one line, where that is missing or the analysis failed: the data
/// are complete then, and the same command goes on from there.
void analyse(const std::filesystem::path& folder);

/// Two pages in `folder` over the analysed runs of studies in its subfolders, in their order: summary.md, the paper's
/// figures against ours, and beyond.md, what the paper did not ask. Throws as analyse() does.
void write_reproduction(const std::filesystem::path& folder, const std::vector<std::string>& of_paper,
                        const std::vector<std::string>& beyond);

}  // namespace raypool::studies
