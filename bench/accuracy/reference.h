/// The image that others are held against: double, deep, no shortcut but those asked for, in two halves of independent
/// random numbers.
///
/// Made a range of samples at a time and kept in a folder, so that it is made once and an interruption loses no more
/// than a range. A file is found by a key over the scene, the image size, the settings and the image of the first
/// sample: if the scene, or what light does, changes, the key is another and nothing old is taken for new. Files are
/// those of checkpoint.h. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "bench/accuracy/configuration.h"
#include "bench/accuracy/statistics.h"
#include "core/film/checkpoint.h"

namespace raypool::accuracy {

/// Seeds of the halves. A measured image must have another.
inline constexpr std::array<std::uint64_t, 2> kReferenceSeeds{0x5265666572656e63, 0x65207365656420ff};

class Reference {
  public:
    /// `half_spp` samples a pixel in each half; an empty folder keeps nothing. `threads` changes no bit.
    Reference(std::shared_ptr<const SceneInBoth> scene, std::int64_t half_spp, std::filesystem::path folder,
              int threads, const Configuration& configuration = kTrusted);

    /// Renders, at most `more` samples a pixel, what is missing of the half with the fewest; and keeps it. Returns the
    /// samples that are missing of both halves. Throws InputError for a file that cannot be written or is damaged.
    std::int64_t extend(std::int64_t more);

    /// Both halves, complete: what is missing is rendered first.
    const Halves& halves();

    /// 16 hexadecimal digits: the files are <scene>-<width>x<height>-<key>-a.sums and -b.sums.
    const std::string& key();

  private:
    void open();
    [[nodiscard]] std::filesystem::path file(std::size_t half);
    void load(std::size_t half);

    std::shared_ptr<const SceneInBoth> scene_;
    std::int64_t half_spp_;
    std::filesystem::path folder_;
    int threads_;
    Configuration configuration_;
    std::string key_;
    std::vector<Checkpoint> halves_;  ///< two, once open
    std::optional<Halves> means_;
};

}  // namespace raypool::accuracy
