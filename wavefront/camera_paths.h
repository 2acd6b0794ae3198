/// Which camera paths come next: the samples of a range of pixels, numbered pixel by pixel.
///
/// The pixels are all of a range of the image, or a list of chosen ones.
///
/// All samples of a pixel come one after the other, so a register of camera rays is as coherent as it can be, and a
/// range of numbers is a piece of work that can be handed to any thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/math/path.h"
#include "core/runtime/loop.h"
#include "core/shading/camera.h"
#include "wavefront/ray_columns.h"

namespace raypool::wavefront {

/// Camera paths, a lane each; the first `count` lanes are meant, the others hold anything that is no harm to trace.
template <class Real>
struct CameraLanes {
    Real x;
    Real y;
    Uint32<Real> pixel;
    Uint32<Real> sample;
    int count;  ///< lanes with a path; the others hold the last one's again, or a later sample of its pixel
};

/// The records of camera rays.
template <Features features, class Real>
RAYPOOL_INLINE RayRecord<Real> camera_record(const Camera<ScalarOf<Real>>& camera, const CameraLanes<Real>& lanes,
                                             const RandomSeed& seed) {
    RayRecord<Real> record;
    record.ray = camera_ray<features, Real>(camera, lanes.x, lanes.y, lanes.pixel, lanes.sample, seed);
    record.throughput = vec3<Real>(Real(1), Real(1), Real(1));
    record.key = {lanes.pixel, lanes.sample};
    record.leaving_id = Uint32<Real>(static_cast<std::uint32_t>(kNoPrimitive));
    record.step = Uint32<Real>(0U);
    record.density = Real(0);
    return record;
}

/// Paths begin .. end - 1 of the samples [first_sample, end_sample) of a range of pixels.
class CameraPaths {
  public:
    CameraPaths(const PixelRange& range, std::int64_t image_width, std::int64_t first_sample, std::int64_t end_sample)
        : range_(range),
          image_width_(image_width),
          first_sample_(first_sample),
          samples_(end_sample - first_sample),
          left_((range.x_end - range.x_begin) * (range.y_end - range.y_begin) * samples_),
          x_(range.x_begin),
          y_(range.y_begin) {}
    /// Of the pixels of a list, which outlives this.
    CameraPaths(std::span<const std::uint32_t> pixels, std::int64_t image_width, std::int64_t first_sample,
                std::int64_t end_sample)
        : CameraPaths(PixelRange{0, static_cast<std::int64_t>(pixels.size()), 0, 1}, image_width, first_sample,
                      end_sample) {
        pixels_ = pixels.data();
    }
    /// Of a unit.
    CameraPaths(const RenderUnit& unit, std::int64_t width, std::int64_t height)
        : CameraPaths(PixelRange{0, width, 0, height}, width, unit.first_sample, unit.end_sample) {
        if (unit.pixels != nullptr) *this = CameraPaths(*unit.pixels, width, unit.first_sample, unit.end_sample);
    }

    [[nodiscard]] bool is_done() const { return left_ == 0; }
    [[nodiscard]] std::int64_t left() const { return left_; }

    /// Paths begin .. begin + count - 1 of these.
    [[nodiscard]] CameraPaths part(std::int64_t begin, std::int64_t count) const {
        CameraPaths part = *this;
        part.seek(begin);
        part.left_ = count;
        return part;
    }

    /// Splits off the next `count` paths.
    CameraPaths take(std::int64_t count) {
        CameraPaths taken = *this;
        taken.left_ = count;
        left_ -= count;
        advance(count);
        return taken;
    }

    /// The next paths, at most `most` and at most a register; there must be one.
    template <class Real>
    RAYPOOL_INLINE CameraLanes<Real> next(std::size_t most) {
        const auto count =
            static_cast<int>(std::min({left_, static_cast<std::int64_t>(most), std::int64_t{kLanes<Real>}}));
        CameraLanes<Real> lanes;
        lanes.count = count;
        left_ -= count;
        if constexpr (Simd<Real>) {
            if (sample_ + count > samples_) {
                fill(lanes, count);
                return lanes;
            }
        }
        const std::int64_t pixel = pixel_at(x_, y_);  // one for all
        lanes.x = Real(static_cast<ScalarOf<Real>>(pixels_ == nullptr ? x_ : pixel % image_width_));
        lanes.y = Real(static_cast<ScalarOf<Real>>(pixels_ == nullptr ? y_ : pixel / image_width_));
        lanes.pixel = Uint32<Real>(static_cast<std::uint32_t>(pixel));
        lanes.sample = Uint32<Real>(static_cast<std::uint32_t>(first_sample_ + sample_)) + lane_numbers<Real>();
        sample_ += count;
        if (sample_ == samples_) next_pixel();
        return lanes;
    }

  private:
    /// Lanes of several pixels. The last path is repeated in the lanes beyond `count`.
    template <class Real>
    [[gnu::noinline]] void fill(CameraLanes<Real>& lanes, int count) requires Simd<Real> {
        alignas(64) ScalarOf<Real> x[kLanes<Real>];
        alignas(64) ScalarOf<Real> y[kLanes<Real>];
        alignas(64) std::uint32_t pixel[kLanes<Real>];
        alignas(64) std::uint32_t sample[kLanes<Real>];
        for (int i = 0; i < count;) {
            const auto here = static_cast<int>(std::min<std::int64_t>(count - i, samples_ - sample_));
            const std::int64_t at = pixel_at(x_, y_);
            const std::int64_t column = pixels_ == nullptr ? x_ : at % image_width_;
            const std::int64_t row = pixels_ == nullptr ? y_ : at / image_width_;
            for (const int end = i + here; i < end; ++i) {
                x[i] = static_cast<ScalarOf<Real>>(column);
                y[i] = static_cast<ScalarOf<Real>>(row);
                pixel[i] = static_cast<std::uint32_t>(at);
                sample[i] = static_cast<std::uint32_t>(first_sample_ + sample_++);
            }
            if (sample_ == samples_) next_pixel();
        }
        for (int i = count; i < kLanes<Real>; ++i) {
            x[i] = x[count - 1];
            y[i] = y[count - 1];
            pixel[i] = pixel[count - 1];
            sample[i] = sample[count - 1];
        }
        lanes.x = Real(x, stdx::vector_aligned);
        lanes.y = Real(y, stdx::vector_aligned);
        lanes.pixel = Uint32<Real>(pixel, stdx::vector_aligned);
        lanes.sample = Uint32<Real>(sample, stdx::vector_aligned);
    }

    [[nodiscard]] std::int64_t pixel_at(std::int64_t x, std::int64_t y) const {
        return pixels_ == nullptr ? y * image_width_ + x : pixels_[x];
    }
    void next_pixel() {
        sample_ = 0;
        if (++x_ == range_.x_end) {
            x_ = range_.x_begin;
            ++y_;
        }
    }
    void seek(std::int64_t path) {
        const std::int64_t pixel = path / samples_;
        const std::int64_t width = range_.x_end - range_.x_begin;
        sample_ = path % samples_;
        x_ = range_.x_begin + pixel % width;
        y_ = range_.y_begin + pixel / width;
    }
    void advance(std::int64_t count) {
        const std::int64_t width = range_.x_end - range_.x_begin;
        seek(((y_ - range_.y_begin) * width + x_ - range_.x_begin) * samples_ + sample_ + count);
    }

    PixelRange range_;                       // of the image, or of the list
    const std::uint32_t* pixels_ = nullptr;  // the list
    std::int64_t image_width_;
    std::int64_t first_sample_;
    std::int64_t samples_;
    std::int64_t left_;
    std::int64_t x_, y_;  // of the next path
    std::int64_t sample_ = 0;
};

}  // namespace raypool::wavefront
