/// Meshes of a scene file: written in place, and placed by a transform.
///
/// Called by scene_parser.cpp alone.
#pragma once

#include "core/scene/json_cursor.h"
#include "core/scene/scene_images.h"

namespace raypool {

/// A mesh by its keys "file", or "vertices", "triangles" and, optional, "uv", and placed by "transform", which is
/// optional. Refuses what is placed beyond kMaxLength. The material is left to the caller.
MeshShape parse_mesh(JsonObject& object, const SceneImages& files);

}  // namespace raypool
