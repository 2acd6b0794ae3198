/// What a tree promises rays, by the areas of its boxes alone.
#pragma once

#include "core/shading/triangle_trees.h"

namespace raypool::studies {

/// A line meets a convex body within another by chance of the ratio of their areas. So these are what a random line
/// through the root's box meets on average, if nothing stops it: the surface area heuristic, without prices.
struct TreeQuality {
    double nodes = 0;      ///< nodes visited, the root too
    double leaves = 0;     ///< leaves visited, a block of shapes each
    double leaf_fill = 0;  ///< shapes of a leaf, of those that it has room for: in (0, 1]
};

/// All zero for an empty tree.
TreeQuality tree_quality(const TriangleTree<float>& tree);

}  // namespace raypool::studies
