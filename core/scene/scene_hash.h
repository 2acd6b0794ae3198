/// A hash of a scene's description: what a cached reference, a checkpoint and a part are known by.
#pragma once

#include <string>

#include "core/scene/scene.h"

namespace raypool {

/// 16 hexadecimal digits over all that shapes the image: camera, background, textures with their texels, materials,
/// shapes and image size; not over name and description.
std::string scene_hash(const Scene& scene);

}  // namespace raypool
