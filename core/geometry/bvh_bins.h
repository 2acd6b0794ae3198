/// Where a range of boxes is cut in two: boxes in bins by the place of their centres, and the cheapest cut between bins
/// (bvh.h names the paper). Minima and counts only, so that the order in which boxes come does not show.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "core/geometry/bvh.h"

namespace raypool::bvh_build {

inline constexpr int kBins = 32;
inline constexpr double kLeastExtent = 1e-290;  ///< of centres worth splitting; keeps kBins / extent finite

/// A box by its low corner and its negated high corner, so that a union is eight minima. Of a box to build over,
/// value[3] is its index. There is no negative zero, since a minimum of two zeros is either.
struct alignas(64) Bounds {
    double value[8];  ///< low x, y, z; unused; -high x, y, z; unused

    static Bounds none() {
        Bounds bounds{};
        std::fill_n(bounds.value, 8, std::numeric_limits<double>::infinity());
        return bounds;
    }
    static Bounds of(const Box& box, std::uint32_t index) {
        Bounds bounds{};
        for (int axis = 0; axis < 3; ++axis) {
            bounds.value[axis] = 0 + box.low[axis];
            bounds.value[4 + axis] = 0 - box.high[axis];
        }
        bounds.value[3] = index;
        return bounds;
    }
    [[nodiscard]] Box box() const { return {{value[0], value[1], value[2]}, {-value[4], -value[5], -value[6]}}; }
    [[nodiscard]] std::uint32_t index() const { return static_cast<std::uint32_t>(value[3]); }
    [[nodiscard]] double extent(int axis) const { return -value[4 + axis] - value[axis]; }
    [[nodiscard]] double center(int axis) const { return 0.5 * value[axis] - 0.5 * value[4 + axis]; }
    [[nodiscard]] Bounds center() const {
        Bounds point{};
        for (int axis = 0; axis < 3; ++axis) {
            point.value[axis] = 0 + center(axis);
            point.value[4 + axis] = 0 - center(axis);
        }
        return point;
    }
    void extend(const Bounds& other) {
#pragma omp simd
        for (int i = 0; i < 8; ++i) value[i] = other.value[i] < value[i] ? other.value[i] : value[i];
    }
};

/// The boxes of a range by the place of their centres along each axis. What no bit of `used` stands for is not set.
struct Bins {
    std::uint32_t used[3] = {};
    std::uint32_t filled[3][kBins];
    Bounds box[3][kBins];

    void add(int axis, int bin, const Bounds& bounds, std::uint32_t count) {
        const std::uint32_t bit = 1U << static_cast<unsigned>(bin);
        if ((used[axis] & bit) != 0) {
            box[axis][bin].extend(bounds);
            filled[axis][bin] += count;
        } else {
            used[axis] |= bit;
            box[axis][bin] = bounds;
            filled[axis][bin] = count;
        }
    }
    void add(const Bins& other) {
        for (int axis = 0; axis < 3; ++axis)
            for (std::uint32_t left = other.used[axis]; left != 0; left &= left - 1) {
                const int bin = std::countr_zero(left);
                add(axis, bin, other.box[axis][bin], other.filled[axis][bin]);
            }
    }
    [[nodiscard]] std::uint32_t count_below(int axis, int end) const {
        std::uint32_t count = 0;
        for (int bin = 0; bin < end; ++bin)
            count += (used[axis] >> static_cast<unsigned>(bin) & 1U) * filled[axis][bin];
        return count;
    }
};

/// Which bin a centre falls into, along each axis.
struct Grid {
    explicit Grid(const Bounds& centers) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = centers.value[axis];
            is_split[axis] = centers.extent(axis) > kLeastExtent;
            scale[axis] = kBins / centers.extent(axis);
        }
    }
    [[nodiscard]] int bin(const Bounds& bounds, int axis) const {
        return std::clamp(static_cast<int>((bounds.center(axis) - low[axis]) * scale[axis]), 0, kBins - 1);
    }
    double low[3], scale[3];
    bool is_split[3];
};

struct Split {
    int axis = -1;  ///< -1: none found
    int bin = 0;    ///< boxes whose bin is below go left
    double cost = std::numeric_limits<double>::infinity();
};

/// Of testing what is in the bounds, in blocks of at most `block` boxes.
inline double split_cost(const Bounds& bounds, std::uint32_t count, std::uint32_t block) {
    const std::uint32_t blocks = (count + block - 1) / block;
    return bounds.box().area() * blocks;
}

inline Split best_split(const Bins& bins, std::uint32_t block) {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        // Sweep from the right for the right-hand costs, then from the left for the sums.
        std::array<double, kBins> right_cost{};
        Bounds right = Bounds::none();
        std::uint32_t right_count = 0;
        for (std::uint32_t rest = bins.used[axis]; rest != 0;) {
            const int bin = static_cast<int>(std::bit_width(rest)) - 1;
            rest ^= 1U << static_cast<unsigned>(bin);
            right.extend(bins.box[axis][bin]);
            right_count += bins.filled[axis][bin];
            right_cost[bin] = split_cost(right, right_count, block);
        }
        Bounds left = Bounds::none();
        std::uint32_t left_count = 0;
        for (std::uint32_t rest = bins.used[axis]; (rest & (rest - 1)) != 0;) {
            const int bin = std::countr_zero(rest);
            rest &= rest - 1;
            left.extend(bins.box[axis][bin]);
            left_count += bins.filled[axis][bin];
            const double sum = split_cost(left, left_count, block) + right_cost[std::countr_zero(rest)];
            if (sum < best.cost) best = {axis, bin + 1, sum};
        }
    }
    return best;
}

}  // namespace raypool::bvh_build
