/// A mesh of triangles that share vertices, as a file gives it.
///
/// What the readers (mesh_reader.h) promise, and whoever makes one by other means keeps:
///   - every number is finite;
///   - every index is below vertex_count();
///   - `normals` and `uv` are empty or have one entry for each vertex;
///   - there are at most kMaxMeshCount vertices and as many triangles.
/// Triangles may be degenerate (of no area, or with one vertex twice), and vertices may be used by none.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raypool {

inline constexpr std::int64_t kMaxMeshCount = (std::int64_t{1} << 31) - 1;

struct Mesh {
    using Triangle = std::array<std::uint32_t, 3>;

    std::vector<std::array<float, 3>> positions;  ///< x, y, z in the scene's unit of length
    /// Of any length. (0, 0, 0) stands for none: a triangle with such a vertex is flat.
    std::vector<std::array<float, 3>> normals;
    std::vector<std::array<float, 2>> uv;  ///< of any range, as the file has them
    std::vector<Triangle> triangles;       ///< indices of vertices, counter-clockwise seen from the front

    [[nodiscard]] std::size_t vertex_count() const { return positions.size(); }
    [[nodiscard]] std::size_t triangle_count() const { return triangles.size(); }

    /// Of the positions along the axes.
    struct Box {
        std::array<float, 3> low, high;
        [[nodiscard]] std::array<std::array<float, 3>, 8> corners() const {
            std::array<std::array<float, 3>, 8> all;
            for (std::size_t i = 0; i < all.size(); ++i)
                for (std::size_t axis = 0; axis < 3; ++axis) all[i][axis] = ((i >> axis & 1U) == 0 ? low : high)[axis];
            return all;
        }
    };
    /// Of a mesh that has a vertex.
    [[nodiscard]] Box box() const {
        Box box{positions.at(0), positions.at(0)};
        for (const auto& position : positions) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box.low[axis] = std::min(box.low[axis], position[axis]);
                box.high[axis] = std::max(box.high[axis], position[axis]);
            }
        }
        return box;
    }

    /// Makes the triangles of a polygon, a fan around the corner that is added first.
    class Fan {
      public:
        explicit Fan(std::vector<Triangle>& triangles) : triangles_(triangles) {}
        void add(std::uint32_t corner) {
            if (corner_count_ == 0) first_ = corner;
            if (corner_count_ >= 2) triangles_.push_back({first_, last_, corner});
            last_ = corner;
            ++corner_count_;
        }
        [[nodiscard]] std::int64_t corner_count() const { return corner_count_; }

      private:
        std::vector<Triangle>& triangles_;
        std::int64_t corner_count_ = 0;
        std::uint32_t first_ = 0, last_ = 0;
    };
};

}  // namespace raypool
