#include "bench/studies/draw.h"

#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/process.h"

namespace raypool::studies {

namespace {

namespace fs = std::filesystem;

/// Beside the command where it is installed, else in the source tree that it was built from.
fs::path script() {
    const fs::path installed = fs::read_symlink("/proc/self/exe").parent_path() / RAYPOOL_INSTALLED_PLOTS / "draw.py";
    return fs::exists(installed) ? installed : fs::path(RAYPOOL_SOURCE_PLOTS) / "draw.py";
}

}  // namespace

void draw_pictures(const fs::path& folder) {
    constexpr const char* kPython = "/usr/bin/python3";  // the one that the distribution's matplotlib is for
    if (run_process({kPython, "-B", script().string(), folder.string()}) != 0)
        throw std::runtime_error(fmt::format(
            "{}: the data are complete, but drawing failed; it needs the packages python3 and python3-matplotlib",
            folder.string()));
}

}  // namespace raypool::studies
