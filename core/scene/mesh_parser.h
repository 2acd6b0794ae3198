/// Meshes of a scene file: written in place, and placed by a transform.
///
/// Called by scene_parser.cpp alone.
#pragma once

#include <array>
#include <memory>

#include "core/scene/json_cursor.h"
#include "core/scene/scene_images.h"

namespace raypool {

/// A mesh by its keys "file", or "vertices", "triangles" and, optional, "uv", and placed by "transform", which is
/// optional. Refuses what is placed beyond kMaxLength. The material is left to the caller.
MeshShape parse_mesh(JsonObject& object, const SceneImages& files);

/// What instances stand for. Its box is all that is looked at for each of them.
struct MeshObject {
    std::shared_ptr<const Mesh> mesh;
    std::array<std::array<float, 3>, 8> corners;
};
/// A mesh by the same keys, less "transform".
MeshObject parse_object(JsonObject object, const SceneImages& files);

/// An instance, placed by "transform", which is optional. Refuses a box that is placed beyond kMaxLength.
MeshShape parse_instance(JsonObject& object, const MeshObject& of);

}  // namespace raypool
