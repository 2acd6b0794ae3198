#include "bench/studies/draw.h"

#include <spawn.h>
#include <sys/wait.h>

#include <cstring>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

extern char** environ;

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
    const std::string file = script().string();
    const std::string target = folder.string();
    const char* arguments[] = {kPython, "-B", file.c_str(), target.c_str(), nullptr};
    pid_t child = 0;
    if (const int error = posix_spawn(&child, kPython, nullptr, nullptr, const_cast<char**>(arguments), environ);
        error != 0)
        throw std::runtime_error(fmt::format("{}: cannot run: {}", kPython, std::strerror(error)));
    int status = 0;
    waitpid(child, &status, 0);
    if (status != 0)
        throw std::runtime_error(fmt::format(
            "{}: the data are complete, but drawing failed; it needs the packages python3 and python3-matplotlib",
            target));
}

}  // namespace raypool::studies
