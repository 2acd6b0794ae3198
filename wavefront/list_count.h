/// How long the lists of rays are that stream traversal takes down a tree, by level: with count_work.
#pragma once

#include <array>

#include "core/geometry/traverse.h"
#include "wavefront/pool_report.h"

namespace raypool::wavefront {

/// Work of stages that counts lists, too.
struct ListCount : TestCount {
    /// The root is level 0; leaves below the deepest nodes are the last.
    std::array<ListLevel, kMostTreeLevels + 1> lists{};
    std::size_t level = 0;

    /// A list at a node or leaf of this level, whose rays go on in registers of `lanes`, or one by one.
    void count_list(std::size_t rays, std::size_t lanes, bool is_single) {
        ListLevel& at = lists[level];
        ++at.lists;
        at.rays += static_cast<std::int64_t>(rays);
        if (is_single)
            at.single_rays += static_cast<std::int64_t>(rays);
        else
            at.lanes += static_cast<std::int64_t>((rays + lanes - 1) / lanes * lanes);
    }
};

}  // namespace raypool::wavefront
