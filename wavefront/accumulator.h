/// Accumulators: the ways in which deposits reach the framebuffer. To compare them is one of the project's experiments.
///
/// An accumulator is made once a render and adds for all threads; finish() is called once, by one thread, when all are
/// done. Those that add integers give the same bits in any order. AtomicReal adds floating-point numbers: its image
/// depends on the order, and so on threads and schedule.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "core/framebuffer.h"
#include "wavefront/deposits.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

template <class Scalar>
class AccumulatorBase {
  public:
    AccumulatorBase() = default;
    AccumulatorBase(const AccumulatorBase&) = delete;
    AccumulatorBase& operator=(const AccumulatorBase&) = delete;
    virtual ~AccumulatorBase() = default;
    virtual void add(const Deposits<Scalar>& deposits, SampleConverter& converter, int thread) = 0;
    virtual void finish() {}
    [[nodiscard]] virtual std::size_t bytes() const { return 0; }
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

/// Plain additions are right as long as no two threads add to a pixel.
enum class Addition : bool { Plain, Atomic };

/// Adds deposits, as integers, to sums in either layout.
template <Addition addition, class Layout, class Scalar>
void add_integers(const Layout& layout, const Deposits<Scalar>& deposits, SampleConverter& converter) {
    const auto add = [](std::int64_t& sum, std::int64_t value) {
        if constexpr (addition == Addition::Atomic) {
            std::atomic_ref(sum).fetch_add(value, std::memory_order_relaxed);
        } else {
            sum += value;
        }
    };
    for (std::size_t i = 0; i < deposits.count(); ++i) {
        const FixedRgb fixed = converter.convert<Scalar>(deposits.radiance(i));
        for (int k = 0; k < 3; ++k) add(layout.at(deposits.pixel(i), k), fixed[static_cast<std::size_t>(k)]);
        // A path that is not split deposits once, so that a deposit is a whole sample.
        if (layout.squares != nullptr) {
            const FixedSquare square = converter.square(fixed);
            std::int64_t* digits = layout.squares + 2 * std::size_t{deposits.pixel(i)};
            add(digits[0], square.low);
            add(digits[1], square.high);
        }
    }
}

/// The framebuffer's own sums of squares, or null.
inline std::int64_t* squares_of(Framebuffer& framebuffer) {
    return framebuffer.has_squares() ? framebuffer.squares().data() : nullptr;
}

/// Adds to the framebuffer itself.
template <class Scalar, Addition addition>
class InterleavedInt64 : public AccumulatorBase<Scalar> {
  public:
    explicit InterleavedInt64(Framebuffer& framebuffer) : sums_{framebuffer.sums().data(), squares_of(framebuffer)} {}
    void add(const Deposits<Scalar>& deposits, SampleConverter& converter, int) override {
        add_integers<addition>(sums_, deposits, converter);
    }

  private:
    Interleaved sums_;
};

/// Adds to three planes, which are put into the framebuffer at the end.
template <class Scalar, Addition addition>
class PlanarInt64 : public AccumulatorBase<Scalar> {
  public:
    explicit PlanarInt64(Framebuffer& framebuffer)
        : sums_(framebuffer.sums()),
          planes_(sums_.size()),
          planar_{planes_.data(), squares_of(framebuffer), sums_.size() / 3} {}
    void add(const Deposits<Scalar>& deposits, SampleConverter& converter, int) override {
        add_integers<addition>(planar_, deposits, converter);
    }
    void finish() override {
        for (std::size_t pixel = 0; pixel < planar_.pixel_count; ++pixel)
            for (int k = 0; k < 3; ++k) Interleaved{sums_.data(), nullptr}.at(pixel, k) += planar_.at(pixel, k);
    }
    [[nodiscard]] std::size_t bytes() const override { return planes_.size() * sizeof(std::int64_t); }

  private:
    std::span<std::int64_t> sums_;
    std::vector<std::int64_t> planes_;
    Planar planar_;
};

/// A framebuffer for each thread, merged at the end.
template <class Scalar>
class PrivateInt64 : public AccumulatorBase<Scalar> {
  public:
    PrivateInt64(Framebuffer& framebuffer, int threads)
        : sums_(framebuffer.sums()), squares_(framebuffer.squares()), parts_(static_cast<std::size_t>(threads)) {
        for (auto& part : parts_) part.resize(sums_.size() + squares_.size());
    }
    void add(const Deposits<Scalar>& deposits, SampleConverter& converter, int thread) override {
        std::int64_t* part = parts_[static_cast<std::size_t>(thread)].data();
        add_integers<Addition::Plain>(Interleaved{part, squares_.empty() ? nullptr : part + sums_.size()}, deposits,
                                      converter);
    }
    void finish() override {
        for (const auto& part : parts_) {
            for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += part[i];
            for (std::size_t i = 0; i < squares_.size(); ++i) squares_[i] += part[sums_.size() + i];
        }
    }
    [[nodiscard]] std::size_t bytes() const override {
        return parts_.size() * (sums_.size() + squares_.size()) * sizeof(std::int64_t);
    }

  private:
    std::span<std::int64_t> sums_;
    std::span<std::int64_t> squares_;
    std::vector<std::vector<std::int64_t>> parts_;  ///< a thread's sums, then its squares
};

/// Atomic additions of floating-point numbers: a compare-and-swap loop. Not reproducible.
template <class Scalar, class Sum>
class AtomicReal : public AccumulatorBase<Scalar> {
  public:
    explicit AtomicReal(Framebuffer& framebuffer) : framebuffer_(framebuffer), sums_(framebuffer.sums().size()) {}
    void add(const Deposits<Scalar>& deposits, SampleConverter&, int) override {
        for (std::size_t i = 0; i < deposits.count(); ++i) {
            const Vec3<Scalar> radiance = deposits.radiance(i);
            Sum* sum = &sums_[3 * std::size_t{deposits.pixel(i)}];
            for (int k = 0; k < 3; ++k)
                std::atomic_ref(sum[k]).fetch_add(static_cast<Sum>(radiance[k]), std::memory_order_relaxed);
        }
    }
    void finish() override {
        const double scale = framebuffer_.fixed_point().scale();
        for (std::size_t i = 0; i < sums_.size(); ++i)
            framebuffer_.sums()[i] += std::llrint(static_cast<double>(sums_[i]) * scale);
    }
    [[nodiscard]] std::size_t bytes() const override { return sums_.size() * sizeof(Sum); }

  private:
    Framebuffer& framebuffer_;
    std::vector<Sum> sums_;
};

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
