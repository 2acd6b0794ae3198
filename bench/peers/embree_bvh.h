/// Binary trees by Embree's builder, for our traversal to walk: what a tree is worth, apart from who walks it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/bvh.h"

namespace raypool::peers {

struct EmbreeBvh {
    BinaryBvh tree;
    double seconds;  ///< that rtcBuildBVH took; not in it: to hand it the boxes, and to make a BinaryBvh of its tree
};

/// By binned SAH (RTC_BUILD_QUALITY_MEDIUM), whose leaves hold at most `block` boxes, in [1, 32], and are priced by the
/// block as ours are. Boxes are exact in float. Without spatial splits Embree's high quality is the same. Throws
/// std::runtime_error where Embree fails.
EmbreeBvh embree_bvh(const std::vector<Box>& boxes, std::uint32_t block, int threads);

}  // namespace raypool::peers
