#include "core/geometry/bvh.h"

#include <algorithm>

namespace raypool {

template <class Scalar, int width>
WideBvh<Scalar, width> collapse(const BinaryBvh& tree) {
    WideBvh<Scalar, width> wide;
    wide.order = tree.order;
    if (tree.nodes.empty()) return wide;

    struct Pending {
        std::uint32_t binary;
        int level;
    };
    std::vector<Pending> pending{{0, 1}};  // pending[i] becomes wide.nodes[i]
    for (std::size_t i = 0; i < pending.size(); ++i) {
        const auto [root, level] = pending[i];
        wide.depth = std::max(wide.depth, level);

        std::vector<std::uint32_t> children{root};
        while (children.size() < width) {
            auto largest = children.end();
            for (auto c = children.begin(); c != children.end(); ++c) {
                const bool is_inner = tree.nodes[*c].count == 0;
                if (is_inner &&
                    (largest == children.end() || tree.nodes[*c].box.area() > tree.nodes[*largest].box.area()))
                    largest = c;
            }
            if (largest == children.end()) break;
            const std::uint32_t opened = *largest;
            *largest = tree.nodes[opened].left;
            children.push_back(tree.nodes[opened].left + 1);
        }

        WideNode<Scalar, width> node;
        for (int lane = 0; lane < width; ++lane) {
            const bool is_used = lane < static_cast<int>(children.size());
            const Box box = is_used ? tree.nodes[children[lane]].box : Box{};
            for (int axis = 0; axis < 3; ++axis) {
                node.bounds[axis][0][lane] = static_cast<Scalar>(box.low[axis]);
                node.bounds[axis][1][lane] = static_cast<Scalar>(box.high[axis]);
            }
            node.child[lane] = 0;
            if (!is_used) continue;
            const BinaryBvh::Node& child = tree.nodes[children[lane]];
            if (child.count > 0) {
                node.child[lane] = ~static_cast<std::int32_t>(wide.leaves.size());
                wide.leaves.push_back({child.first, child.count});
            } else {
                node.child[lane] = static_cast<std::int32_t>(pending.size());
                pending.push_back({children[lane], level + 1});
            }
        }
        wide.nodes.push_back(node);
    }
    return wide;
}

// The widths of all processors (kTreeWidth), so that tests walk other trees than this one's, too.
template WideBvh<float, 4> collapse(const BinaryBvh&);
template WideBvh<float, 8> collapse(const BinaryBvh&);
template WideBvh<double, 2> collapse(const BinaryBvh&);
template WideBvh<double, 4> collapse(const BinaryBvh&);
template WideBvh<double, 8> collapse(const BinaryBvh&);

}  // namespace raypool
