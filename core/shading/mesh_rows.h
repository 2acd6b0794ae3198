/// The rows of meshes among the tables of a compiled scene: triangles, vertices, their normals and uv; and instances.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/geometry/bvh.h"
#include "core/scene/scene.h"
#include "core/shading/compiled_scene.h"

namespace raypool {

/// Among those of SceneTables::triangles.
struct TriangleRows {
    std::uint32_t first, count;
};
/// A mesh that has instances.
struct ObjectRows : TriangleRows {
    Box box;  ///< of its vertices, in its own space
};

/// Meshes that stand alone come first, then instances, whose rows are their objects'.
template <class Scalar>
class MeshRows {
  public:
    explicit MeshRows(SceneTables<Scalar>& tables) : tables_(tables) {}

    /// `surface` is the row of its material.
    void add(const MeshShape& shape, std::size_t surface);
    /// Its triangles have the ids from `first_id` on. The row lacks the root of the object's tree.
    void add_instance(const MeshShape& shape, std::size_t surface, std::int64_t first_id);
    /// After the last mesh.
    void finish();

    [[nodiscard]] const std::vector<ObjectRows>& objects() const { return objects_; }

  private:
    /// The rows of a mesh; where `is_turned`, its triangles are turned over.
    void add(const MeshShape& shape, bool is_turned, std::size_t surface);
    void add_normals(const MeshShape& shape, std::size_t first_vertex);
    const ObjectRows& object(const MeshShape& shape, std::size_t surface);

    SceneTables<Scalar>& tables_;
    std::vector<ObjectRows> objects_;
    /// By the mesh, and by whether its triangles are turned over: then the order of vertices is another.
    std::map<std::pair<const Mesh*, bool>, std::size_t> object_of_;
};

extern template class MeshRows<float>;
extern template class MeshRows<double>;

}  // namespace raypool
