#include "bench/studies/generated_scene.h"

#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/process.h"
#include "core/scene_reader.h"

namespace raypool::studies {

namespace {

namespace fs = std::filesystem;

/// Beside the command where it is installed, else in the source tree that it was built from.
fs::path generator() {
    const fs::path installed = fs::read_symlink("/proc/self/exe").parent_path() / RAYPOOL_INSTALLED_SCENES / "generate";
    return fs::exists(installed) ? installed : fs::path(RAYPOOL_SOURCE_SCENES) / "generate";
}

struct TemporaryFile {
    explicit TemporaryFile(const std::string& name)
        : path(fs::temp_directory_path() / fmt::format("raypool-{}-{}", getpid(), name)) {}
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        std::error_code ignored;
        fs::remove(path, ignored);
    }
    fs::path path;
};

}  // namespace

Scene generated_scene(const std::string& kind, std::int64_t shapes) {
    const TemporaryFile file(fmt::format("{}-{}.json", shapes, kind));
    if (run_process({"/usr/bin/python3", "-B", generator().string(), std::to_string(shapes), kind, "-o",
                     file.path.string()}) != 0)
        throw std::runtime_error(fmt::format("{} could not make {} {}", generator().string(), shapes, kind));
    Scene scene = read_scene(file.path);
    scene.name = fmt::format("{} {}", shapes, kind);
    return scene;
}

}  // namespace raypool::studies
