// The binary tree. Ranges of many boxes are split by all threads together; what is left then are subtrees, each built
// by one thread. Where a range is cut depends on its boxes alone, by minima and counts that are the same in any order,
// and boxes keep their order on either side: so the tree is the same, bit for bit, for any number of threads.
//
// Boxes are moved from one buffer to another and back, so that each range is read from first to last: 128 bytes a box
// for the two, while the tree is built. Threads are as many as OpenMP gives by default.

#include <omp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <utility>

#include "core/base/error.h"
#include "core/base/first_exception.h"
#include "core/geometry/bvh.h"
#include "core/geometry/bvh_bins.h"

namespace raypool {

namespace bvh_build {

namespace {

/// Boxes that are worth a thread: below it takes longer to wake it.
constexpr std::uint32_t kThreadBoxes = 32768;
/// Subtrees that a larger tree is cut into, about, whatever the number of threads: one thread's work each. A range that
/// all threads split costs them several meetings, so few are.
constexpr std::uint32_t kSubtrees = 64;
constexpr std::uint32_t kSubtreeBoxes = 8192;  ///< of a subtree, at least
constexpr std::uint32_t kChunk = 2048;         ///< boxes of a larger range that a thread takes at a time

/// Boxes [first, first + count) of one of the two buffers.
struct Range {
    std::uint32_t first, count;
    int level;
    int buffer;
    Bounds box;
    Bounds centers;
};

class Builder {
  public:
    Builder(const std::vector<Box>& boxes, std::uint32_t block)
        : block_(block),
          threads_(std::min(omp_get_max_threads(), static_cast<int>(boxes.size() / kThreadBoxes) + 1)),
          subtree_boxes_(std::max(kSubtreeBoxes, static_cast<std::uint32_t>(boxes.size() / kSubtrees))),
          buffers_{std::make_unique_for_overwrite<Bounds[]>(boxes.size()),
                   std::make_unique_for_overwrite<Bounds[]>(boxes.size())} {
        tree_.order.resize(boxes.size());
#pragma omp parallel for schedule(static) num_threads(threads_) if (threads_ > 1)
        for (std::size_t i = 0; i < boxes.size(); ++i)
            buffers_[0][i] = Bounds::of(boxes[i], static_cast<std::uint32_t>(i));
    }

    BinaryBvh build() {
        if (tree_.order.empty()) return std::move(tree_);
        struct Part {
            Range range;
            std::uint32_t node;
            std::vector<BinaryBvh::Node> nodes;
        };
        // Split what is large by all threads together.
        std::vector<Part> parts{{measured({0, static_cast<std::uint32_t>(tree_.order.size()), 0, 0, {}, {}}), 0, {}}};
        tree_.nodes.emplace_back();
        for (std::size_t i = 0; i < parts.size();) {
            if (parts[i].range.count <= std::max(subtree_boxes_, block_)) {
                ++i;
                continue;
            }
            const auto [left, right] = split_by_all(parts[i].range);
            const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
            tree_.nodes[parts[i].node] = inner(parts[i].range, first);
            tree_.nodes.resize(first + 2);
            parts[i] = {left, first, {}};
            parts.push_back({right, first + 1, {}});
        }
        // Build a subtree a thread, the largest first.
        std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
            return std::pair(b.range.count, a.node) < std::pair(a.range.count, b.node);
        });
        FirstException failed;
#pragma omp parallel for schedule(dynamic) num_threads(threads_) if (threads_ > 1)
        for (std::size_t i = 0; i < parts.size(); ++i)
            failed.run([&] { build_subtree(parts[i].range, parts[i].nodes); });
        failed.rethrow();
        // Put them behind each other. The first node of each has its place already.
        for (const Part& part : parts) {
            const auto offset = static_cast<std::uint32_t>(tree_.nodes.size()) - 1;
            tree_.nodes.insert(tree_.nodes.end(), part.nodes.begin() + 1, part.nodes.end());
            tree_.nodes[part.node] = part.nodes.front();
            for (std::size_t k = 0; k < part.nodes.size(); ++k)
                if (part.nodes[k].count == 0) tree_.nodes[k == 0 ? part.node : offset + k].left += offset;
        }
        return std::move(tree_);
    }

  private:
    static BinaryBvh::Node inner(const Range& range, std::uint32_t left) {
        return {.box = range.box.box(), .left = left, .first = range.first, .count = 0};
    }

    /// Nodes count from the subtree's first.
    void build_subtree(const Range& root, std::vector<BinaryBvh::Node>& nodes) {
        std::vector<std::pair<Range, std::uint32_t>> open{{root, 0}};
        nodes.emplace_back();
        while (!open.empty()) {
            const auto [range, node] = open.back();
            open.pop_back();
            if (range.count <= block_) {
                nodes[node] = {.box = range.box.box(), .left = 0, .first = range.first, .count = range.count};
                for (std::uint32_t i = range.first; i < range.first + range.count; ++i)
                    tree_.order[i] = buffers_[range.buffer][i].index();
                continue;
            }
            const auto [left, right] = split_alone(range);
            const auto first = static_cast<std::uint32_t>(nodes.size());
            nodes[node] = inner(range, first);
            nodes.resize(first + 2);
            open.emplace_back(right, first + 1);
            open.emplace_back(left, first);
        }
    }

    [[nodiscard]] Range measured(Range range) const {
        range.box = range.centers = Bounds::none();
        for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
            range.box.extend(buffers_[range.buffer][i]);
            range.centers.extend(buffers_[range.buffer][i].center());
        }
        return range;
    }

    [[nodiscard]] std::pair<Range, Range> halves(const Range& range) const {
        const std::uint32_t half = range.count / 2;
        return {measured({range.first, half, range.level + 1, range.buffer, {}, {}}),
                measured({range.first + half, range.count - half, range.level + 1, range.buffer, {}, {}})};
    }

    void fill(const Range& range, const Grid& grid, std::uint32_t first, std::uint32_t end, Bins& bins) const {
        const Bounds* boxes = buffers_[range.buffer].get();
        for (std::uint32_t i = first; i < end; ++i)
            for (int axis = 0; axis < 3; ++axis)
                if (grid.is_split[axis]) bins.add(axis, grid.bin(boxes[i], axis), boxes[i], 1);
    }

    /// The two sides as far as bins know them: all but their centres.
    static std::pair<Range, Range> sides(const Range& range, const Bins& bins, const Split& split) {
        const std::uint32_t count = bins.count_below(split.axis, split.bin);
        Range left{range.first, count, range.level + 1, 1 - range.buffer, Bounds::none(), Bounds::none()};
        Range right = left;
        right.first += count;
        right.count = range.count - count;
        for (std::uint32_t rest = bins.used[split.axis]; rest != 0; rest &= rest - 1) {
            const int bin = std::countr_zero(rest);
            (bin < split.bin ? left : right).box.extend(bins.box[split.axis][bin]);
        }
        return {left, right};
    }

    /// Moves boxes [first, end) to the other buffer: those of the left from to[0] on, the others from to[1] on.
    void move(const Range& range, const Grid& grid, const Split& split, std::uint32_t first, std::uint32_t end,
              std::array<std::uint32_t, 2> to, std::array<Bounds, 2>& centers) {
        const Bounds* from = buffers_[range.buffer].get();
        Bounds* target = buffers_[1 - range.buffer].get();
        for (std::uint32_t i = first; i < end; ++i) {
            const int side = grid.bin(from[i], split.axis) < split.bin ? 0 : 1;
            target[to[side]++] = from[i];
            centers[side].extend(from[i].center());
        }
    }

    std::pair<Range, Range> split_alone(const Range& range) {
        if (range.level >= kMostSahLevels) return halves(range);
        const Grid grid(range.centers);
        const std::uint32_t end = range.first + range.count;
        Bins bins;
        fill(range, grid, range.first, end, bins);
        const Split split = best_split(bins, block_);
        if (split.axis < 0) return halves(range);  // all centres coincide
        auto [left, right] = sides(range, bins, split);
        std::array<Bounds, 2> centers{Bounds::none(), Bounds::none()};
        move(range, grid, split, range.first, end, {left.first, right.first}, centers);
        left.centers = centers[0];
        right.centers = centers[1];
        return {left, right};
    }

    /// As split_alone(), chunk by chunk.
    std::pair<Range, Range> split_by_all(const Range& range) {
        if (range.level >= kMostSahLevels) return halves(range);
        const Grid grid(range.centers);
        const std::uint32_t chunks = (range.count + kChunk - 1) / kChunk;
        const auto chunk_begin = [&](std::uint32_t chunk) {
            return range.first + std::min(chunk * kChunk, range.count);
        };
        using Counts = std::array<std::uint32_t, kBins>;
        std::vector<std::array<Counts, 3>> below(chunks);  // boxes of a chunk in bins below a bin, by axis
        Bins all;
#pragma omp parallel num_threads(threads_) if (threads_ > 1)
        {
            Bins mine;
#pragma omp for schedule(static) nowait
            for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
                Bins bins;
                fill(range, grid, chunk_begin(chunk), chunk_begin(chunk + 1), bins);
                for (int axis = 0; axis < 3; ++axis)
                    for (int bin = 0; bin < kBins; ++bin) below[chunk][axis][bin] = bins.count_below(axis, bin);
                mine.add(bins);
            }
#pragma omp critical(raypool_bvh_bins)
            all.add(mine);
        }
        const Split split = best_split(all, block_);
        if (split.axis < 0) return halves(range);
        std::pair<Range, Range> both = sides(range, all, split);
        std::vector<std::array<std::uint32_t, 2>> to(chunks);
        std::array<std::uint32_t, 2> next{both.first.first, both.second.first};
        for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
            const std::uint32_t left = below[chunk][split.axis][split.bin];
            to[chunk] = next;
            next[0] += left;
            next[1] += chunk_begin(chunk + 1) - chunk_begin(chunk) - left;
        }
#pragma omp parallel num_threads(threads_) if (threads_ > 1)
        {
            std::array<Bounds, 2> centers{Bounds::none(), Bounds::none()};
#pragma omp for schedule(static) nowait
            for (std::uint32_t chunk = 0; chunk < chunks; ++chunk)
                move(range, grid, split, chunk_begin(chunk), chunk_begin(chunk + 1), to[chunk], centers);
#pragma omp critical(raypool_bvh_centers)
            {
                both.first.centers.extend(centers[0]);
                both.second.centers.extend(centers[1]);
            }
        }
        return both;
    }

    std::uint32_t block_;
    int threads_;
    std::uint32_t subtree_boxes_;  ///< of a subtree, at most
    std::unique_ptr<Bounds[]> buffers_[2];
    BinaryBvh tree_;
};

}  // namespace

}  // namespace bvh_build

BinaryBvh build_binary_bvh(const std::vector<Box>& boxes, std::uint32_t block) {
    RAYPOOL_CHECK(block > 0, "a leaf holds at least one primitive");
    RAYPOOL_CHECK(boxes.size() <= kMostBoxes, "a traversal's stack holds the tree");
    return bvh_build::Builder(boxes, block).build();
}

}  // namespace raypool
