#include "bench/studies/generated_scene.h"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/process.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

namespace fs = std::filesystem;

/// Beside the command where it is installed, else in the source tree that it was built from.
fs::path generator() {
    const fs::path installed = fs::read_symlink("/proc/self/exe").parent_path() / RAYPOOL_INSTALLED_SCENES / "generate";
    return fs::exists(installed) ? installed : fs::path(RAYPOOL_SOURCE_SCENES) / "generate";
}

}  // namespace

GeneratedScene::GeneratedScene(const std::string& kind, std::int64_t shapes)
    : name_(fmt::format("{} {}", shapes, kind)) {
    if (run_process(
            {"/usr/bin/python3", "-B", generator().string(), std::to_string(shapes), kind, "-o", path().string()}) != 0)
        throw std::runtime_error(fmt::format("{} could not make {}", generator().string(), name_));
}

Scene GeneratedScene::read() const {
    Scene scene = read_scene(path());
    scene.name = name_;
    return scene;
}

}  // namespace raypool::studies
