#include "core/runtime/balanced_items.h"

#include <iterator>

namespace raypool {

namespace {

/// A thread's item is this part of its equal share of what is left. Neighbouring pixels cost alike, and a dear item may
/// cost several times the mean: it must not outlast all the others.
constexpr std::int64_t kItemsAShare = 8;
/// Pixels are kept whole where a thread has at least so many.
constexpr std::int64_t kWholePixels = 64;
/// No item is smaller, in paths, but for the last: a few registers, and some microseconds beside which fetching it is
/// little.
constexpr std::int64_t kLeastPaths = 64;

}  // namespace

BalancedItems::BalancedItems(std::int64_t pixels, std::int64_t samples, int threads)
    : samples_(std::max<std::int64_t>(samples, 1)),
      path_count_(pixels * samples),
      splits_pixels_(threads > 1 && samples > 1 && pixels < kWholePixels * threads) {
    const std::int64_t step = splits_pixels_ ? 1 : samples_;
    const std::int64_t least = (kLeastPaths + step - 1) / step * step;
    for (std::int64_t path = 0; path < path_count_;) {
        const std::int64_t left = path_count_ - path;
        const std::int64_t shared = threads == 1 ? left : left / (kItemsAShare * threads) / step * step;
        const std::int64_t size = std::max(least, shared);
        const std::int64_t most = size == least ? left : threads;  // none can be smaller
        const std::int64_t items = std::min(most, (left + size - 1) / size);
        batches_.push_back({count_, path, size});
        count_ += items;
        path += items * size;
    }
}

BalancedItems::BalancedItems(std::int64_t width, std::int64_t height, const RenderUnit& unit, int threads)
    : BalancedItems(unit.pixels == nullptr ? width * height : std::ssize(*unit.pixels),
                    unit.end_sample - unit.first_sample, threads) {}

const BalancedItems::Batch& BalancedItems::batch_of(std::int64_t item) const {
    return *std::prev(std::upper_bound(batches_.begin(), batches_.end(), item,
                                       [](std::int64_t i, const Batch& batch) { return i < batch.first_item; }));
}

PathRange BalancedItems::range(std::int64_t item) const {
    const Batch& batch = batch_of(item);
    const std::int64_t begin = batch.first_path + (item - batch.first_item) * batch.item_paths;
    return {begin, std::min(begin + batch.item_paths, path_count_)};
}

std::int64_t BalancedItems::most_held(std::int64_t item) const {
    return batch_of(item).item_paths;
}

}  // namespace raypool
