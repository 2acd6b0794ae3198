#include "cli/preview.h"

#include <exception>

#include "cli/print.h"
#include "core/base/output_file.h"
#include "core/image/image_file.h"

namespace raypool::cli {

namespace {

constexpr std::chrono::seconds kBetween{2};

}  // namespace

Preview::Preview(const PreviewOptions& options, const std::string& name, const PixelWindow& part)
    : file_(options.file), part_(part) {
    if (!file_.empty()) {
        image_format(file_);
        check_writable(file_);
    }
    if (!options.server.empty())
        server_.emplace(options.server).create(name, part.x_end - part.x_begin, part.y_end - part.y_begin);
}

bool Preview::is_due() const {
    return (!file_.empty() || server_) && (!shown_ || Clock::now() - *shown_ >= kBetween);
}

void Preview::show(const Checkpoint& sums) {
    const auto attempt = [](const char* option, const auto& work, const auto& give_up) {
        try {
            work();
        } catch (const std::exception& error) {
            print(stderr, "raypool: {}: {}; the render goes on without it\n", option, error.what());
            give_up();
        }
    };
    const Image image = sums.sample_counts.empty() ? sums.framebuffer.cut(part_).image(sums.sample_count())
                                                   : sums.framebuffer.image(sums.sample_counts);
    if (!file_.empty()) {
        ImageAttributes attributes;
        if (sums.sample_counts.empty()) attributes["raypool.samples_done"] = fmt::to_string(sums.sample_count());
        attempt(
            "--preview", [&] { write_image(file_, image, attributes); }, [&] { file_.clear(); });
    }
    if (server_)
        attempt(
            "--display-server", [&] { server_->update(image); }, [&] { server_.reset(); });
    shown_ = Clock::now();
}

}  // namespace raypool::cli
