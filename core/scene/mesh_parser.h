/// Meshes of a scene file: written in place, and placed by a transform.
///
/// Called by scene_parser.cpp alone.
#pragma once

#include <memory>

#include "core/scene/json_cursor.h"
#include "core/scene/scene_images.h"

namespace raypool {

/// A mesh by its keys "file", or "vertices", "triangles" and, optional, "uv", and placed by "transform", which is
/// optional. Refuses what is placed beyond kMaxLength. The material is left to the caller.
MeshShape parse_mesh(JsonObject& object, const SceneImages& files);

/// A mesh by the same keys, less "transform": what instances stand for.
std::shared_ptr<const Mesh> parse_object(JsonObject object, const SceneImages& files);

/// An instance of an object, placed by "transform", which is optional; refuses as parse_mesh() does.
MeshShape parse_instance(JsonObject& object, std::shared_ptr<const Mesh> mesh);

}  // namespace raypool
