/// A render on disk, exact: the integer sums of its samples so far, and which samples those are.
///
/// It is what a checkpoint is, and a part: `render --checkpoint` and `render --part` write it, `render --resume` and
/// `merge` read it. Integer sums add up exactly, so a render that was interrupted, split or merged ends in the bits of
/// one that was not.
///
/// The step of the sums is the same for all numbers of samples up to FixedPoint::kExtensibleSamples, and above by
/// powers of two: so a render can be extended to more samples, or its parts planned with different ones, and end in the
/// bits of one render of them all.
///
/// A file is a line of JSON, the sums, and 16 hexadecimal digits over all before them (XXH3). It appears whole or not
/// at all (output_file.h). A file that is short, long, damaged, or of another version is refused by name (InputError);
/// no more is allocated than its own size calls for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/film/framebuffer.h"

namespace raypool {

/// Samples [first, end) of every pixel.
struct SampleRange {
    std::int64_t first;
    std::int64_t end;
    bool operator==(const SampleRange&) const = default;
};

/// Raised when the same settings come to make another image, so that sums of before and of after are not added up. The
/// test of the golden hashes (tests/equivalence/golden_test.cpp) tells when.
inline constexpr int kImageVersion = 3;

/// Everything that fixes the image, by name: two renders with the same key add up, others must not.
using ImageKey = std::vector<std::pair<std::string, std::string>>;

/// The first thing wanted that is found to be different, "depth 50, not 20"; empty where the keys agree.
std::string difference(const ImageKey& found, const ImageKey& wanted);

struct Checkpoint {
    ImageKey key;
    std::int64_t spp;                 ///< samples a pixel that the whole shall have, at most
    std::vector<SampleRange> ranges;  ///< rising and apart: those that touch are one. Empty for an adaptive render
    std::vector<std::int32_t> sample_counts;  ///< of an adaptive render, by pixel
    int rounds = 0;                           ///< of an adaptive render
    Framebuffer framebuffer;

    [[nodiscard]] std::int64_t sample_count() const;
};

/// Throws InputError, saying what differs, unless the sums of both can be added up: one key, size and step, and both
/// adaptive or neither. A file is not believed to have what its key says.
void check_same_render(const Checkpoint& found, const Checkpoint& wanted);

/// `ranges` with one more; throws InputError where samples would be there twice.
std::vector<SampleRange> with_range(std::vector<SampleRange> ranges, const SampleRange& more);

/// What of [0, end) is in none of the ranges.
std::vector<SampleRange> gaps(const std::vector<SampleRange>& ranges, std::int64_t end);

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& sums);
Checkpoint read_checkpoint(const std::filesystem::path& path);
/// The content of a file, which refusals call `name`.
Checkpoint decode_checkpoint(std::string_view content, const std::string& name);

}  // namespace raypool
