/// The pictures of a study: made by scripts/plots/draw.py from data.csv and run.json.
#pragma once

#include <filesystem>

namespace raypool::studies {

/// Draws every picture that run.json lists, as SVG and PNG. Needs Debian's python3-matplotlib. Throws
/// std::runtime_error, saying how to get it, where that is missing, or with the exit status where drawing failed.
void draw_pictures(const std::filesystem::path& folder);

}  // namespace raypool::studies
