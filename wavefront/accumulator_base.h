/// Accumulators: the ways in which contributions reach the framebuffer. To compare them is one of the project's
/// experiments.
///
/// An accumulator is made once a session and adds for all threads. Those that keep sums of their own bring them into
/// the framebuffer, and begin anew, by merge(), a block of pixels at a time: threads may merge different blocks at
/// once, and none adds meanwhile.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#include "core/film/framebuffer.h"
#include "wavefront/contributions.h"

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

}  // namespace raypool::wavefront
