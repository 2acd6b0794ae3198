/// Accumulators that add integers: they give the same bits in any order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/film/framebuffer.h"
#include "wavefront/accumulator_base.h"
#include "wavefront/contributions.h"

namespace raypool::wavefront {

/// Where the three sums of a pixel are: side by side, as in the framebuffer, or each in a plane of its own. To compare
/// them is the paper's "interleaved against three planar framebuffers". Here and below a pixel is a cell of the
/// framebuffer: half a pixel where it keeps halves apart.
struct Interleaved {
    std::int64_t* sums;
    [[nodiscard]] std::int64_t& at(std::size_t pixel, int k) const {
        return sums[3 * pixel + static_cast<std::size_t>(k)];
    }
};
struct Planar {
    std::int64_t* sums;
    std::size_t pixel_count;
    [[nodiscard]] std::int64_t& at(std::size_t pixel, int k) const {
        return sums[static_cast<std::size_t>(k) * pixel_count + pixel];
    }
};

/// Contributions as integers, one after the other: converted eight at a time where the processor can.
template <class Scalar>
class EightContributions {
  public:
    EightContributions(const Contributions<Scalar>& contributions, SampleConverter& converter)
        : contributions_(contributions), converter_(converter) {}

    /// For i = 0, 1, 2, ... in turn.
    RAYPOOL_INLINE FixedRgb fixed(std::size_t i) {
        if constexpr (isa::kRoundsEight && sizeof(Scalar) == sizeof(float)) {
            if (i % 8 == 0)
                are_converted_ = i + 8 <= contributions_.count() &&
                                 convert_eight(converter_,
                                               {contributions_.channel(0, i), contributions_.channel(1, i),
                                                contributions_.channel(2, i)},
                                               fixed_);
            if (are_converted_) return {fixed_[0][i % 8], fixed_[1][i % 8], fixed_[2][i % 8]};
        }
        return converter_.convert<Scalar>(contributions_.radiance(i));
    }

  private:
    const Contributions<Scalar>& contributions_;
    SampleConverter& converter_;
    bool are_converted_ = false;
    std::int64_t fixed_[3][8];
};

/// Adds contributions, as integers, to sums in either layout: those of a pixel that follow each other at once, since an
/// atomic addition takes longer than all the rest, and by far where threads want the same pixel.
template <Addition addition, class Layout, class Scalar>
void add_integers(const Layout& layout, const Contributions<Scalar>& contributions, SampleConverter& converter) {
    EightContributions<Scalar> eight(contributions, converter);
    for (std::size_t i = 0; i < contributions.count();) {
        const std::uint32_t pixel = contributions.pixel(i);
        FixedRgb sum{};
        do {
            const FixedRgb fixed = eight.fixed(i);
            for (std::size_t k = 0; k < 3; ++k) sum[k] += fixed[k];
        } while (++i < contributions.count() && contributions.pixel(i) == pixel);
        for (int k = 0; k < 3; ++k) add_to<addition>(layout.at(pixel, k), sum[static_cast<std::size_t>(k)]);
    }
}

/// Adds to sums of all threads: of Addition::Plain, atomically only where threads share pixels.
template <class Scalar, class Layout, Addition addition>
class SharedInt64 : public AccumulatorBase<Scalar> {
  public:
    explicit SharedInt64(const Layout& layout) : layout_(layout) {}
    void add(const Contributions<Scalar>& contributions, SampleConverter& converter, int) final {
        if (addition_ == Addition::Plain) {
            add_integers<Addition::Plain>(layout_, contributions, converter);
        } else {
            add_integers<Addition::Atomic>(layout_, contributions, converter);
        }
    }
    void share_pixels(bool are_shared) final { addition_ = are_shared ? Addition::Atomic : addition; }

  protected:
    Layout layout_;

  private:
    Addition addition_ = addition;
};

/// Adds to the framebuffer itself.
template <class Scalar, Addition addition>
class InterleavedInt64 : public SharedInt64<Scalar, Interleaved, addition> {
  public:
    explicit InterleavedInt64(Framebuffer& framebuffer)
        : SharedInt64<Scalar, Interleaved, addition>({framebuffer.sums().data()}) {}
};

/// Adds to three planes, which merge() puts into the framebuffer.
template <class Scalar, Addition addition>
class PlanarInt64 : public SharedInt64<Scalar, Planar, addition> {
    using Base = SharedInt64<Scalar, Planar, addition>;

  public:
    explicit PlanarInt64(Framebuffer& framebuffer)
        : PlanarInt64(framebuffer, Zeros<std::int64_t>(framebuffer.sums().size())) {}
    [[nodiscard]] std::size_t block_count() const override { return block_count_of(this->layout_.pixel_count); }
    void merge(std::size_t block) override {
        const std::size_t end = std::min((block + 1) * kBlockPixels, this->layout_.pixel_count);
        for (std::size_t pixel = block * kBlockPixels; pixel < end; ++pixel)
            for (int k = 0; k < 3; ++k)
                Interleaved{sums_.data()}.at(pixel, k) += std::exchange(this->layout_.at(pixel, k), 0);
    }

  private:
    PlanarInt64(Framebuffer& framebuffer, Zeros<std::int64_t> planes)
        : Base({planes.data(), framebuffer.cell_count()}), sums_(framebuffer.sums()), planes_(std::move(planes)) {}

    std::span<std::int64_t> sums_;
    Zeros<std::int64_t> planes_;
};

/// A framebuffer for each thread, of which merge() reads those blocks that the thread has added to.
template <class Scalar>
class PrivateInt64 : public AccumulatorBase<Scalar> {
  public:
    PrivateInt64(Framebuffer& framebuffer, int threads) : sums_(framebuffer.sums()) {
        parts_.reserve(static_cast<std::size_t>(threads));
        const std::vector<std::uint8_t> unused(block_count_of(sums_.size() / 3), 0);
        for (int i = 0; i < threads; ++i) parts_.push_back({Zeros<std::int64_t>(sums_.size()), unused});
    }
    void add(const Contributions<Scalar>& contributions, SampleConverter& converter, int thread) override {
        Part& part = parts_[static_cast<std::size_t>(thread)];
        add_integers<Addition::Plain>(Interleaved{part.sums.data()}, contributions, converter);
        for (std::size_t i = 0; i < contributions.count(); ++i) part.is_used[contributions.pixel(i) / kBlockPixels] = 1;
    }
    [[nodiscard]] std::size_t block_count() const override { return block_count_of(sums_.size() / 3); }
    void merge(std::size_t block) override {
        const std::size_t begin = 3 * block * kBlockPixels;
        const std::size_t end = std::min(begin + 3 * kBlockPixels, sums_.size());
        for (Part& part : parts_) {
            if (std::exchange(part.is_used[block], std::uint8_t{0}) == 0) continue;
            for (std::size_t i = begin; i < end; ++i) sums_[i] += std::exchange(part.sums.data()[i], 0);
        }
    }

  private:
    struct Part {
        Zeros<std::int64_t> sums;
        std::vector<std::uint8_t> is_used;  ///< by block
    };
    std::span<std::int64_t> sums_;
    std::vector<Part> parts_;  ///< by thread
};

}  // namespace raypool::wavefront
