/// Scenes of any number of shapes, made by scenes/generate: study `scene-size`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/base/scratch_folder.h"
#include "core/scene/scene.h"

namespace raypool::studies {

/// What scenes/generate knows how to strew.
inline constexpr const char* kSceneKinds[] = {"spheres", "quads", "cluster"};

/// What the script wrote, which goes when this does. `shapes` is in [1, 10^7]. Needs python3; throws
/// std::runtime_error where the script fails.
class GeneratedScene {
  public:
    GeneratedScene(const std::string& kind, std::int64_t shapes);

    [[nodiscard]] std::filesystem::path path() const { return folder_ / "scene.json"; }
    [[nodiscard]] Scene read() const;

  private:
    std::string name_;
    ScratchFolder folder_;
};

}  // namespace raypool::studies
