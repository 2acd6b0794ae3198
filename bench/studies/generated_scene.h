/// Scenes of any number of shapes, made by scenes/generate: study `scene-size`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/scene.h"

namespace raypool::studies {

/// What scenes/generate knows how to strew.
inline constexpr const char* kSceneKinds[] = {"spheres", "quads", "cluster"};

/// Runs the script, which needs python3, and reads what it wrote; no file is left. `shapes` is in [1, 10^7]. Throws
/// std::runtime_error where the script fails.
Scene generated_scene(const std::string& kind, std::int64_t shapes);

}  // namespace raypool::studies
