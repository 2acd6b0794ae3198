/// Things that are nearly equal, found by a key of theirs: a sum of their numbers with coefficients that no scene has.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace raypool {

class NearbyKeys {
  public:
    /// The first listed of those added whose key is within `window` and that `is_equal`.
    template <class IsEqual>
    [[nodiscard]] std::optional<std::uint32_t> find(double key, double window, IsEqual is_equal) const {
        std::optional<std::uint32_t> first;
        const auto end = by_key_.upper_bound(key + window);
        for (auto at = by_key_.lower_bound(key - window); at != end; ++at)
            if ((!first || at->second < *first) && is_equal(at->second)) first = at->second;
        return first;
    }
    void add(double key, std::uint32_t index) { by_key_.emplace(key, index); }

  private:
    std::multimap<double, std::uint32_t> by_key_;
};

struct KeyWindow {
    double key;
    double window;  ///< keys of equal things differ by no more
    std::uint32_t index;
};

/// By index, 1 for what is_equal(a, b), which is symmetric and throws nothing, to something else whose key is within
/// its window. Windows of equal things differ by less than a factor of two. Runs on OpenMP's threads.
template <class IsEqual>
std::vector<std::uint8_t> have_equal(std::vector<KeyWindow> things, IsEqual is_equal) {
    constexpr std::size_t kFewest = 16384;  // things that are worth threads
    std::sort(things.begin(), things.end(), [](const KeyWindow& a, const KeyWindow& b) { return a.key < b.key; });
    std::vector<std::uint8_t> found(things.size());
#pragma omp parallel for schedule(dynamic, 4096) if (things.size() > kFewest)
    for (std::size_t i = 0; i < things.size(); ++i) {
        const KeyWindow& thing = things[i];
        const double reach = 2 * thing.window;
        bool is_found = false;
        for (std::size_t k = i; !is_found && k-- > 0 && things[k].key >= thing.key - reach;)
            is_found = is_equal(things[k].index, thing.index);
        for (std::size_t k = i + 1; !is_found && k < things.size() && things[k].key <= thing.key + reach; ++k)
            is_found = is_equal(things[k].index, thing.index);
        found[thing.index] = is_found ? 1 : 0;
    }
    return found;
}

}  // namespace raypool
