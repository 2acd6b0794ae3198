/// A render that is looked at while it runs: an image file that is written anew, and a server of images.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "cli/image_server.h"
#include "core/film/checkpoint.h"

namespace raypool::cli {

struct PreviewOptions {
    std::string file;    ///< empty: none
    std::string server;  ///< HOST:PORT; empty: none
};

/// Shows the mean of the samples that there are, every two seconds at most. Where it cannot, it says so once on
/// standard error and gives up: the render goes on.
class Preview {
  public:
    /// Of a part of the image, which may be all of it. Refuses (InputError) a file that cannot be written and a server
    /// that does not answer.
    Preview(const PreviewOptions& options, const std::string& name, const PixelWindow& part);

    [[nodiscard]] bool is_due() const;
    /// `sums` hold all that was rendered.
    void show(const Checkpoint& sums);

  private:
    using Clock = std::chrono::steady_clock;
    std::string file_;
    PixelWindow part_;
    std::optional<ImageServer> server_;
    std::optional<Clock::time_point> shown_;
};

}  // namespace raypool::cli
