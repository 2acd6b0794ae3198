/// Which boxes span the scene: a ray is likely to meet them wherever it goes, so a tree would only be in the way.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/geometry/bvh.h"

namespace raypool {

/// A box is large when its area is more than this part of that of the box of all smaller ones.
inline constexpr double kLargeArea = 0.01;

/// The places of the large boxes, the largest first, as long as each dwarfs all that are smaller; at most `most`.
inline std::vector<std::uint32_t> large_boxes(const std::vector<Box>& boxes, std::size_t most) {
    std::vector<double> area(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) area[i] = boxes[i].area();
    std::vector<std::uint32_t> by_area(boxes.size());
    std::iota(by_area.begin(), by_area.end(), 0U);
    most = std::min(most, boxes.size());
    std::partial_sort(by_area.begin(), by_area.begin() + static_cast<std::ptrdiff_t>(most), by_area.end(),
                      [&](std::uint32_t a, std::uint32_t b) { return area[a] != area[b] ? area[a] > area[b] : a < b; });

    std::vector<double> area_after(most);
    Box after;
    for (std::size_t i = boxes.size(); i-- > 0;) {
        if (i < most) area_after[i] = after.area();
        after.extend(boxes[by_area[i]]);
    }
    std::size_t count = 0;
    while (count < most && area[by_area[count]] > kLargeArea * area_after[count]) ++count;
    by_area.resize(count);
    return by_area;
}

}  // namespace raypool
