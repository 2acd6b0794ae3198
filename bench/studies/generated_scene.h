/// Scenes of any number of shapes, which the scripts scenes/generate and scenes/generate_mesh write.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "bench/studies/renders.h"
#include "core/base/scratch_folder.h"

namespace raypool::studies {

/// Whether scenes/generate_mesh makes scenes of the kind, of triangles; all others are for scenes/generate.
bool is_mesh(const std::string& kind);

/// The files of one, which go when this does. Needs python3; throws std::runtime_error where the script fails.
class GeneratedScene {
  public:
    GeneratedScene(const std::string& kind, std::int64_t shapes);
    [[nodiscard]] std::filesystem::path path() const { return folder_ / "scene.json"; }

  private:
    ScratchFolder folder_;
};

/// What is in them. Named by its kind and size.
Scene generated_description(const std::string& kind, std::int64_t shapes);

/// One at a width, compiled.
std::shared_ptr<const StudyScene> generated_scene(const std::string& kind, std::int64_t shapes, std::int64_t width);

}  // namespace raypool::studies
