/// Quads by place, to be taken one after the other: which of those left are near a box and a plane.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/bvh.h"

namespace raypool {

class QuadIndex {
  public:
    explicit QuadIndex(std::vector<Box> boxes) : boxes_(std::move(boxes)), tree_(build_binary_bvh(boxes_, 4)) {
        parent_.resize(tree_.nodes.size());
        free_count_.resize(tree_.nodes.size());
        leaf_.resize(boxes_.size());
        is_taken_.resize(boxes_.size());
        for (std::uint32_t i = static_cast<std::uint32_t>(tree_.nodes.size()); i-- > 0;) {
            const BinaryBvh::Node& node = tree_.nodes[i];
            free_count_[i] = node.count;
            for (std::uint32_t k = node.first; k < node.first + node.count; ++k) leaf_[tree_.order[k]] = i;
            if (node.count > 0) continue;
            free_count_[i] = free_count_[node.left] + free_count_[node.left + 1];
            parent_[node.left] = parent_[node.left + 1] = i;
        }
    }

    [[nodiscard]] bool is_taken(std::uint32_t quad) const { return is_taken_[quad]; }
    [[nodiscard]] const Box& box(std::uint32_t quad) const { return boxes_[quad]; }
    /// All quads, those that are near each other side by side.
    [[nodiscard]] const std::vector<std::uint32_t>& by_place() const { return tree_.order; }

    void take(std::uint32_t quad) {
        is_taken_[quad] = true;
        for (std::uint32_t node = leaf_[quad];; node = parent_[node]) {
            --free_count_[node];
            if (node == 0) return;
        }
    }

    /// Calls visit(quad) for the quads not taken whose boxes meet `box` and the plane. Visit may take that quad.
    template <class Visit>
    void for_each_near(const Box& box, const Vector3d& point, const Vector3d& normal, Visit visit) {
        has_near(box, point, normal, [&](std::uint32_t quad) {
            visit(quad);
            return false;
        });
    }

    /// Whether is_wanted(quad) for one of these quads. Allocates nothing.
    template <class IsWanted>
    bool has_near(const Box& box, const Vector3d& point, const Vector3d& normal, IsWanted is_wanted) const {
        const auto is_near = [&](const Box& other) {
            if ((other.low.array() > box.high.array()).any() || (other.high.array() < box.low.array()).any())
                return false;
            const double height = normal.dot(0.5 * (other.low + other.high) - point);
            return std::abs(height) <= normal.cwiseAbs().dot(0.5 * (other.high - other.low));
        };
        if (tree_.nodes.empty()) return false;
        std::array<std::uint32_t, kMostTreeLevels + 1> open;  // a node of each level, and one more
        std::size_t open_count = 0;
        open[open_count++] = 0;
        while (open_count > 0) {
            const std::uint32_t i = open[--open_count];
            const BinaryBvh::Node& node = tree_.nodes[i];
            if (free_count_[i] == 0 || !is_near(node.box)) continue;
            if (node.count == 0) {
                open[open_count++] = node.left + 1;
                open[open_count++] = node.left;
                continue;
            }
            for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
                const std::uint32_t quad = tree_.order[k];
                if (!is_taken_[quad] && is_near(boxes_[quad]) && is_wanted(quad)) return true;
            }
        }
        return false;
    }

  private:
    std::vector<Box> boxes_;
    BinaryBvh tree_;
    std::vector<std::uint32_t> parent_;
    std::vector<std::uint32_t> free_count_;  ///< quads below a node that are not taken
    std::vector<std::uint32_t> leaf_;        ///< by quad
    std::vector<bool> is_taken_;
};

}  // namespace raypool
