#include "bench/studies/generated_scene.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/process.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

std::string generated_name(const std::string& kind, std::int64_t shapes) {
    return fmt::format("{} {}", shapes, kind);
}

}  // namespace

bool is_mesh(const std::string& kind) {
    constexpr std::array kStrewn{"spheres", "quads", "cluster"};
    return std::find(kStrewn.begin(), kStrewn.end(), kind) == kStrewn.end();
}

GeneratedScene::GeneratedScene(const std::string& kind, std::int64_t shapes) {
    const std::string script =
        is_mesh(kind) ? own_script(RAYPOOL_INSTALLED_SCENES "/generate_mesh", RAYPOOL_SOURCE_SCENES "/generate_mesh")
                      : own_script(RAYPOOL_INSTALLED_SCENES "/generate", RAYPOOL_SOURCE_SCENES "/generate");
    if (run_process({kPython, "-B", script, std::to_string(shapes), kind, "-o", path().string()}) != 0)
        throw std::runtime_error(fmt::format("{} could not make {}", script, generated_name(kind, shapes)));
}

Scene generated_description(const std::string& kind, std::int64_t shapes) {
    Scene scene = read_scene(GeneratedScene(kind, shapes).path());
    scene.name = generated_name(kind, shapes);
    return scene;
}

std::shared_ptr<const StudyScene> generated_scene(const std::string& kind, std::int64_t shapes, std::int64_t width) {
    Scene scene = generated_description(kind, shapes);
    set_width(scene, width);
    return std::make_shared<const StudyScene>(StudyScene{scene.name, compile<float>(scene)});
}

}  // namespace raypool::studies
