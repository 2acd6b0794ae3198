/// What traversal counts, or not: boxes and shapes that were tested.
#pragma once

#include <bit>
#include <cstdint>

#include "core/geometry/bvh.h"
#include "core/math/vec.h"

namespace raypool {

struct TestCount {
    std::int64_t box_tests = 0;        ///< children of tree nodes, one by one
    std::int64_t primitive_tests = 0;  ///< shapes, one by one

    template <class Scalar, int width>
    void count(const WideNode<Scalar, width>& node) {
        for (int i = 0; i < width; ++i) box_tests += node.bounds[0][0][i] <= node.bounds[0][1][i] ? 1 : 0;
    }
    template <class Block>
    void count(const Block& block) {
        for (const std::int32_t id : block.id) primitive_tests += id != kNoPrimitive ? 1 : 0;
    }
    /// Child `lane` of a node, for the rays set in `rays`.
    template <class Scalar, int width>
    void count_boxes(const WideNode<Scalar, width>& node, int lane, unsigned rays) {
        if (node.bounds[0][0][lane] <= node.bounds[0][1][lane]) box_tests += std::popcount(rays);
    }
    void count_primitives(int rays) { primitive_tests += rays; }
    void begin_segment() {}  ///< called by the per-pixel tracer; a log of segments overrides it
};

struct NoTestCount {
    static constexpr std::int64_t box_tests = 0;
    static constexpr std::int64_t primitive_tests = 0;
    RAYPOOL_INLINE void count(const auto&) {}
    RAYPOOL_INLINE void count_boxes(const auto&, int, unsigned) {}
    RAYPOOL_INLINE void count_primitives(int) {}
    RAYPOOL_INLINE void begin_segment() {}
};

}  // namespace raypool
