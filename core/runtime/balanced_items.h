/// The default cut of a unit of a render into items of work: large ones first and small ones last, for any number of
/// threads, any size of image and any number of samples.
///
/// Paths are numbered pixel by pixel, the samples of a pixel one after the other, and an item is a range of these
/// numbers: some pixels, or some samples of a pixel. Items are for whichever thread is free; they shrink as "factoring"
/// has it (Hummel, Schonberg and Flynn, 1992): a part of what is left in equal items, one for each thread, again and
/// again. Items are of whole pixels, which then belong to one thread, as long as a pixel is a small part of a thread's
/// share. Where it is not, boundaries lie anywhere, and contributions must be added atomically. Pure.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/runtime/loop.h"

namespace raypool {

/// Paths [begin, end) of a unit.
struct PathRange {
    std::int64_t begin;
    std::int64_t end;
};

class BalancedItems {
  public:
    /// Of `pixels` with `samples` each, for at least one thread.
    BalancedItems(std::int64_t pixels, std::int64_t samples, int threads);
    /// Of a unit of an image, which has paths.
    BalancedItems(std::int64_t width, std::int64_t height, const RenderUnit& unit, int threads);

    [[nodiscard]] std::int64_t count() const { return count_; }
    [[nodiscard]] PathRange range(std::int64_t item) const;
    /// Whether items may hold a part of a pixel's samples, so that threads share pixels.
    [[nodiscard]] bool splits_pixels() const { return splits_pixels_; }
    /// What the thread that has the item should hold in a pool at most, in records: by the end of a render little is
    /// left that others could take over, so no thread may sit on much.
    [[nodiscard]] std::int64_t most_held(std::int64_t item) const;

    /// Calls visit(LinePixels, first sample, end sample) for parts of an item that lie in one line each, numbers of
    /// samples counted from the first of the unit.
    template <class Visit>
    void for_each_line(std::int64_t item, std::int64_t width, const std::vector<std::uint32_t>* list,
                       Visit visit) const {
        const PathRange paths = range(item);
        for (std::int64_t path = paths.begin; path < paths.end;) {
            const std::int64_t pixel = path / samples_;
            const std::int64_t sample = path % samples_;
            const std::int64_t whole = sample == 0 ? (paths.end - path) / samples_ : 0;
            const std::int64_t count = list != nullptr ? 1 : std::clamp<std::int64_t>(whole, 1, width - pixel % width);
            const std::int64_t end = whole == 0 ? std::min(samples_, sample + paths.end - path) : samples_;
            visit(list == nullptr ? LinePixels{pixel, nullptr, count} : LinePixels{0, list->data() + pixel, 1}, sample,
                  end);
            path += whole == 0 ? end - sample : count * samples_;
        }
    }

  private:
    /// Items of one size, but for the last of all.
    struct Batch {
        std::int64_t first_item;
        std::int64_t first_path;
        std::int64_t item_paths;
    };
    [[nodiscard]] const Batch& batch_of(std::int64_t item) const;

    std::int64_t samples_;
    std::int64_t path_count_;
    bool splits_pixels_;
    std::vector<Batch> batches_;
    std::int64_t count_ = 0;
};

}  // namespace raypool
