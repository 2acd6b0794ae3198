/// Accumulators: the ways in which contributions reach the framebuffer. To compare them is one of the project's
/// experiments.
///
/// An accumulator is made once a session and adds for all threads. Those that keep sums of their own bring them into
/// the framebuffer, and begin anew, by merge(), a block of pixels at a time: threads may merge different blocks at
/// once, and none adds meanwhile. Those that add integers give the same bits in any order. AtomicReal adds
/// floating-point numbers: its image depends on the order, and so on threads and schedule.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "core/film/framebuffer.h"
#include "wavefront/contributions.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

template <class Scalar>
class AccumulatorBase {
  public:
    AccumulatorBase() = default;
    AccumulatorBase(const AccumulatorBase&) = delete;
    AccumulatorBase& operator=(const AccumulatorBase&) = delete;
    virtual ~AccumulatorBase() = default;
    virtual void add(const Contributions<Scalar>& contributions, SampleConverter& converter, int thread) = 0;
    /// Whether threads share pixels from now on. An accumulator that relies on owned pixels must know. For one thread.
    virtual void share_pixels(bool /*are_shared*/) {}
    /// 0 where it adds to the framebuffer itself.
    [[nodiscard]] virtual std::size_t block_count() const { return 0; }
    virtual void merge(std::size_t /*block*/) {}
};

/// Brings everything into the framebuffer, in one thread.
template <class Scalar>
void merge_all(AccumulatorBase<Scalar>& accumulator) {
    for (std::size_t block = 0; block < accumulator.block_count(); ++block) accumulator.merge(block);
}

/// Pixels that are merged at a time.
inline constexpr std::size_t kBlockPixels = 1024;
inline std::size_t block_count_of(std::size_t pixels) {
    return (pixels + kBlockPixels - 1) / kBlockPixels;
}

/// Zeros, which take memory where they are first written to only, and near the thread that does.
template <class T>
class Zeros {
  public:
    explicit Zeros(std::size_t size)
        : memory_(static_cast<T*>(std::calloc(std::max<std::size_t>(size, 1), sizeof(T)))) {
        if (memory_ == nullptr) throw std::bad_alloc();
    }
    [[nodiscard]] T* data() const { return memory_.get(); }

  private:
    struct Free {
        void operator()(T* memory) const { std::free(memory); }
    };
    std::unique_ptr<T[], Free> memory_;
};

/// Where the three sums of a pixel are: side by side, as in the framebuffer, or each in a plane of its own. To compare
/// them is the paper's "interleaved against three planar framebuffers". The sums of squares, where the framebuffer
/// keeps them (null elsewhere), are apart from both, two digits a pixel.
struct Interleaved {
    std::int64_t* sums;
    std::int64_t* squares;
    [[nodiscard]] std::int64_t& at(std::size_t pixel, int k) const {
        return sums[3 * pixel + static_cast<std::size_t>(k)];
    }
};
struct Planar {
    std::int64_t* sums;
    std::int64_t* squares;
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
        if constexpr (x86::kRoundsEight && sizeof(Scalar) == sizeof(float)) {
            if (i % 8 == 0)
                are_converted_ = i + 8 <= contributions_.count() &&
                                 converter_.convert_eight({contributions_.channel(0, i), contributions_.channel(1, i),
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
    const bool has_squares = layout.squares != nullptr;
    EightContributions<Scalar> eight(contributions, converter);
    for (std::size_t i = 0; i < contributions.count();) {
        const std::uint32_t pixel = contributions.pixel(i);
        FixedRgb sum{};
        FixedSquare square;
        do {
            const FixedRgb fixed = eight.fixed(i);
            for (std::size_t k = 0; k < 3; ++k) sum[k] += fixed[k];
            // A path that is not split contributions once, so that a contribution is a whole sample.
            if (has_squares) square.add(converter.square(fixed));
        } while (++i < contributions.count() && contributions.pixel(i) == pixel);
        for (int k = 0; k < 3; ++k) add_to<addition>(layout.at(pixel, k), sum[static_cast<std::size_t>(k)]);
        if (has_squares) {
            std::int64_t* digits = layout.squares + 2 * std::size_t{pixel};
            add_to<addition>(digits[0], square.low);
            add_to<addition>(digits[1], square.high);
        }
    }
}

/// The framebuffer's own sums of squares, or null.
inline std::int64_t* squares_of(Framebuffer& framebuffer) {
    return framebuffer.has_squares() ? framebuffer.squares().data() : nullptr;
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
        : SharedInt64<Scalar, Interleaved, addition>({framebuffer.sums().data(), squares_of(framebuffer)}) {}
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
                Interleaved{sums_.data(), nullptr}.at(pixel, k) += std::exchange(this->layout_.at(pixel, k), 0);
    }

  private:
    PlanarInt64(Framebuffer& framebuffer, Zeros<std::int64_t> planes)
        : Base({planes.data(), squares_of(framebuffer), framebuffer.sums().size() / 3}),
          sums_(framebuffer.sums()),
          planes_(std::move(planes)) {}

    std::span<std::int64_t> sums_;
    Zeros<std::int64_t> planes_;
};

/// A framebuffer for each thread, of which merge() reads those blocks that the thread has added to.
template <class Scalar>
class PrivateInt64 : public AccumulatorBase<Scalar> {
  public:
    PrivateInt64(Framebuffer& framebuffer, int threads) : sums_(framebuffer.sums()), squares_(framebuffer.squares()) {
        parts_.reserve(static_cast<std::size_t>(threads));
        const std::vector<std::uint8_t> unused(block_count_of(sums_.size() / 3), 0);
        for (int i = 0; i < threads; ++i)
            parts_.push_back({Zeros<std::int64_t>(sums_.size() + squares_.size()), unused});
    }
    void add(const Contributions<Scalar>& contributions, SampleConverter& converter, int thread) override {
        Part& part = parts_[static_cast<std::size_t>(thread)];
        std::int64_t* sums = part.sums.data();
        add_integers<Addition::Plain>(Interleaved{sums, squares_.empty() ? nullptr : sums + sums_.size()},
                                      contributions, converter);
        for (std::size_t i = 0; i < contributions.count(); ++i) part.is_used[contributions.pixel(i) / kBlockPixels] = 1;
    }
    [[nodiscard]] std::size_t block_count() const override { return block_count_of(sums_.size() / 3); }
    void merge(std::size_t block) override {
        const std::size_t begin = block * kBlockPixels;
        const std::size_t end = std::min(begin + kBlockPixels, sums_.size() / 3);
        for (Part& part : parts_) {
            if (std::exchange(part.is_used[block], std::uint8_t{0}) == 0) continue;
            take(part.sums.data(), sums_, 3 * begin, 3 * end);
            take(part.sums.data() + sums_.size(), squares_, squares_per_pixel() * begin, squares_per_pixel() * end);
        }
    }

  private:
    struct Part {
        Zeros<std::int64_t> sums;           ///< and behind them the squares
        std::vector<std::uint8_t> is_used;  ///< by block
    };
    [[nodiscard]] std::size_t squares_per_pixel() const { return squares_.size() / (sums_.size() / 3); }
    static void take(std::int64_t* from, std::span<std::int64_t> to, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) to[i] += std::exchange(from[i], 0);
    }
    std::span<std::int64_t> sums_;
    std::span<std::int64_t> squares_;
    std::vector<Part> parts_;  ///< by thread
};

/// Atomic additions of floating-point numbers: a compare-and-swap loop. Not reproducible.
template <class Scalar, class Sum>
class AtomicReal : public AccumulatorBase<Scalar> {
  public:
    explicit AtomicReal(Framebuffer& framebuffer) : framebuffer_(framebuffer), sums_(framebuffer.sums().size()) {}
    void add(const Contributions<Scalar>& contributions, SampleConverter&, int) override {
        for (std::size_t i = 0; i < contributions.count(); ++i) {
            const Vec3<Scalar> radiance = contributions.radiance(i);
            Sum* sum = sums_.data() + 3 * std::size_t{contributions.pixel(i)};
            for (int k = 0; k < 3; ++k)
                std::atomic_ref(sum[k]).fetch_add(static_cast<Sum>(radiance[k]), std::memory_order_relaxed);
        }
    }
    [[nodiscard]] std::size_t block_count() const override { return block_count_of(framebuffer_.sums().size() / 3); }
    void merge(std::size_t block) override {
        const double scale = framebuffer_.fixed_point().scale();
        const std::span<std::int64_t> out = framebuffer_.sums();
        const std::size_t end = std::min(3 * (block + 1) * kBlockPixels, out.size());
        for (std::size_t i = 3 * block * kBlockPixels; i < end; ++i)
            out[i] += std::llrint(static_cast<double>(std::exchange(sums_.data()[i], Sum{0})) * scale);
    }

  private:
    Framebuffer& framebuffer_;
    Zeros<Sum> sums_;
};

/// What the sums of an accumulator of its own take; 0 where it adds to the framebuffer itself.
inline std::size_t accumulator_bytes(Accumulator kind, const Framebuffer& framebuffer, int threads) {
    const std::size_t sums = framebuffer.sums().size();
    switch (kind) {
        case Accumulator::OwnedInt64:
        case Accumulator::AtomicInt64:
            return 0;
        case Accumulator::PrivateInt64:
            return static_cast<std::size_t>(threads) *
                   ((sums + framebuffer.squares().size()) * sizeof(std::int64_t) + block_count_of(sums / 3));
        case Accumulator::OwnedPlanarInt64:
        case Accumulator::AtomicPlanarInt64:
            return sums * sizeof(std::int64_t);
        case Accumulator::AtomicFloat:
            return sums * sizeof(float);
        case Accumulator::AtomicDouble:
            return sums * sizeof(double);
    }
    return 0;
}

template <class Scalar>
std::unique_ptr<AccumulatorBase<Scalar>> make_accumulator(Accumulator kind, Framebuffer& framebuffer, int threads) {
    switch (kind) {
        case Accumulator::OwnedInt64:
            return std::make_unique<InterleavedInt64<Scalar, Addition::Plain>>(framebuffer);
        case Accumulator::AtomicInt64:
            return std::make_unique<InterleavedInt64<Scalar, Addition::Atomic>>(framebuffer);
        case Accumulator::PrivateInt64:
            return std::make_unique<PrivateInt64<Scalar>>(framebuffer, threads);
        case Accumulator::OwnedPlanarInt64:
            return std::make_unique<PlanarInt64<Scalar, Addition::Plain>>(framebuffer);
        case Accumulator::AtomicPlanarInt64:
            return std::make_unique<PlanarInt64<Scalar, Addition::Atomic>>(framebuffer);
        case Accumulator::AtomicFloat:
            return std::make_unique<AtomicReal<Scalar, float>>(framebuffer);
        case Accumulator::AtomicDouble:
            return std::make_unique<AtomicReal<Scalar, double>>(framebuffer);
    }
    return nullptr;
}

}  // namespace raypool::wavefront
