/// The accumulator that adds floating-point numbers: its image depends on the order, and so on threads and schedule.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/film/framebuffer.h"
#include "wavefront/accumulator_base.h"
#include "wavefront/contributions.h"

namespace raypool::wavefront {

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

}  // namespace raypool::wavefront
