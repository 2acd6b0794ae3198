#include "core/bvh.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/error.h"
#include "core/real.h"

namespace raypool {

namespace {

constexpr int kBins = 32;
constexpr double kLeastExtent = 1e-290;  ///< of centres worth splitting; keeps kBins / extent finite

struct Split {
    int axis = -1;  ///< -1: none found
    int bin = 0;    ///< boxes whose bin is below go left
    double cost = std::numeric_limits<double>::infinity();
};

struct Binning {
    double low;
    double scale;
    [[nodiscard]] int bin(double center) const {
        return std::clamp(static_cast<int>((center - low) * scale), 0, kBins - 1);
    }
};

class Builder {
  public:
    Builder(const std::vector<Box>& boxes, std::uint32_t block) : boxes_(boxes), block_(block) {
        tree_.order.resize(boxes.size());
        std::iota(tree_.order.begin(), tree_.order.end(), 0U);
    }

    BinaryBvh build() {
        if (boxes_.empty()) return std::move(tree_);
        tree_.nodes.push_back(node(0, static_cast<std::uint32_t>(boxes_.size())));
        std::vector<std::uint8_t> level{0};
        for (std::size_t i = 0; i < tree_.nodes.size(); ++i) {  // grows as it goes: no recursion, so no depth limit
            const std::uint32_t first = tree_.nodes[i].first;
            const std::uint32_t count = tree_.nodes[i].count;
            if (count <= block_) continue;
            const std::uint32_t middle = level[i] < kMostSahLevels ? partition(first, count) : first + count / 2;
            tree_.nodes[i].left = static_cast<std::uint32_t>(tree_.nodes.size());
            tree_.nodes[i].count = 0;
            tree_.nodes.push_back(node(first, middle - first));
            tree_.nodes.push_back(node(middle, first + count - middle));
            level.insert(level.end(), 2, static_cast<std::uint8_t>(level[i] + 1));
        }
        return std::move(tree_);
    }

  private:
    [[nodiscard]] Eigen::Vector3d center(std::uint32_t box) const {
        return 0.5 * boxes_[box].low + 0.5 * boxes_[box].high;
    }
    [[nodiscard]] double blocks(std::uint32_t count) const {
        const std::uint32_t whole = (count + block_ - 1) / block_;
        return whole;
    }

    [[nodiscard]] BinaryBvh::Node node(std::uint32_t first, std::uint32_t count) const {
        BinaryBvh::Node result{.box = {}, .left = 0, .first = first, .count = count};
        for (std::uint32_t i = first; i < first + count; ++i) result.box.extend(boxes_[tree_.order[i]]);
        return result;
    }

    [[nodiscard]] Binning binning(const Box& centers, int axis) const {
        return {centers.low[axis], kBins / (centers.high[axis] - centers.low[axis])};
    }

    [[nodiscard]] Split best_split(std::uint32_t first, std::uint32_t count, const Box& centers) const {
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            if (!(centers.high[axis] - centers.low[axis] > kLeastExtent)) continue;
            const Binning bins = binning(centers, axis);
            std::array<Box, kBins> box;
            std::array<std::uint32_t, kBins> filled{};
            for (std::uint32_t i = first; i < first + count; ++i) {
                const int b = bins.bin(center(tree_.order[i])[axis]);
                box[b].extend(boxes_[tree_.order[i]]);
                ++filled[b];
            }
            // Sweep from the right for the right-hand costs, then from the left for the sums.
            std::array<double, kBins> right_cost{};
            Box right;
            std::uint32_t right_count = 0;
            for (int b = kBins - 1; b > 0; --b) {
                right.extend(box[b]);
                right_count += filled[b];
                right_cost[b] = right_count == 0 ? 0 : right.area() * blocks(right_count);
            }
            Box left;
            std::uint32_t left_count = 0;
            for (int b = 1; b < kBins; ++b) {
                left.extend(box[b - 1]);
                left_count += filled[b - 1];
                if (left_count == 0 || left_count == count) continue;
                const double cost = left.area() * blocks(left_count) + right_cost[b];
                if (cost < best.cost) best = {axis, b, cost};
            }
        }
        return best;
    }

    /// Reorders order[first .. first + count) and returns where the right-hand part begins.
    std::uint32_t partition(std::uint32_t first, std::uint32_t count) {
        Box centers;
        for (std::uint32_t i = first; i < first + count; ++i) {
            const Eigen::Vector3d c = center(tree_.order[i]);
            centers.extend({c, c});
        }
        const Split split = best_split(first, count, centers);
        if (split.axis < 0) return first + count / 2;  // all centres coincide
        const Binning bins = binning(centers, split.axis);
        const auto begin = tree_.order.begin() + first;
        const auto middle = std::stable_partition(
            begin, begin + count, [&](std::uint32_t box) { return bins.bin(center(box)[split.axis]) < split.bin; });
        return static_cast<std::uint32_t>(middle - tree_.order.begin());
    }

    const std::vector<Box>& boxes_;
    std::uint32_t block_;
    BinaryBvh tree_;
};

}  // namespace

BinaryBvh build_binary_bvh(const std::vector<Box>& boxes, std::uint32_t block) {
    RAYPOOL_CHECK(block > 0, "a leaf holds at least one primitive");
    RAYPOOL_CHECK(boxes.size() <= kMostBoxes, "a traversal's stack holds the tree");
    return Builder(boxes, block).build();
}

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

template WideBvh<float, 4> collapse(const BinaryBvh&);  // of tests: another tree, the same hits
template WideBvh<float, 8> collapse(const BinaryBvh&);
template WideBvh<double, 4> collapse(const BinaryBvh&);
#ifdef __AVX512F__
template WideBvh<double, 8> collapse(const BinaryBvh&);
#endif

}  // namespace raypool
