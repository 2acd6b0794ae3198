/// The shared pool, and the ways in which survivors of a round reach the next: to compare them is an experiment.
///
/// Records are worked on in batches, a range of the pool each, by one thread at a time. When a batch is done, enqueue()
/// enqueues its survivors; when all are, every thread calls end_round(), between two barriers. A new strategy is a
/// class with these two functions. Where threads must wait for each other in between, end_round() calls the `wait`
/// that it is given, so that waiting is not taken for work.
/// Thread safety: enqueue() may be called by several threads for different batches; all else is read-only in a round.
#pragma once

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "wavefront/ray_columns.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

/// Hands out camera paths 0 .. total - 1 to threads.
class PathCounter {
  public:
    struct Part {
        std::int64_t begin;
        std::int64_t count;
    };
    explicit PathCounter(std::int64_t total) : total_(total) {}
    /// Up to `most` paths that no other thread gets.
    Part take(std::size_t most) {
        const std::int64_t begin = next_.fetch_add(static_cast<std::int64_t>(most), std::memory_order_relaxed);
        return {begin, std::clamp<std::int64_t>(total_ - begin, 0, static_cast<std::int64_t>(most))};
    }
    [[nodiscard]] bool is_done() const { return next_.load(std::memory_order_relaxed) >= total_; }

  private:
    std::int64_t total_;
    std::atomic<std::int64_t> next_ = 0;
};

/// How `capacity` records lie in batches of about `batch`, each with slots for all branches of a path: capacity is at
/// least 2^split_depth.
struct PoolShape {
    PoolShape(std::size_t capacity, std::size_t batch, int split_depth)
        : batch_count(std::min((capacity + batch - 1) / batch, capacity >> static_cast<unsigned>(split_depth))),
          stride(((capacity + batch_count - 1) / batch_count + kPadding - 1) / kPadding * kPadding),
          allocated(stride * batch_count + kSlotsToGenerate) {}

    static constexpr std::size_t kSlotsToGenerate = 64;  ///< camera paths may be written behind a full range
    std::size_t batch_count;
    std::size_t stride;     ///< from batch to batch: whole registers, so that no two threads touch one
    std::size_t allocated;  ///< records that memory is allocated for
};

template <Features features, class Scalar>
class SharedPool {
  public:
    using Records = RayColumns<features, Scalar>;

    SharedPool(std::size_t capacity, std::size_t batch, int split_depth)
        : shape_(capacity, batch, split_depth),
          batch_count_(shape_.batch_count),
          stride_(shape_.stride),
          camera_capacity_(std::max<std::size_t>(capacity >> static_cast<unsigned>(split_depth), 1)),
          split_depth_(split_depth),
          records_(allocated()) {}
    SharedPool(const SharedPool&) = delete;
    SharedPool& operator=(const SharedPool&) = delete;
    virtual ~SharedPool() = default;

    Records& records() { return records_; }
    /// Records that a batch can have.
    [[nodiscard]] std::size_t batch() const { return stride_; }
    [[nodiscard]] std::int64_t batch_count() const { return static_cast<std::int64_t>(batch_count_); }
    [[nodiscard]] std::size_t first(std::int64_t b) const { return static_cast<std::size_t>(b) * stride_; }
    /// Records in the pool, between two rounds.
    [[nodiscard]] std::size_t size() const { return total_; }
    [[nodiscard]] bool is_empty() const { return total_ == 0; }

    /// Records of a batch at the start of the round.
    [[nodiscard]] virtual std::size_t count(std::int64_t b) const = 0;
    /// How many camera paths a batch may take in, once its survivors are enqueued.
    [[nodiscard]] virtual std::size_t free_slots(std::int64_t b) const = 0;
    /// Enqueues records [from, from + front) and `split` records of `overflow`. Returns where in the batch's range
    /// the next records may be put.
    virtual std::size_t enqueue(std::int64_t b, std::size_t from, std::size_t front, const Records& overflow,
                                std::size_t split) = 0;
    virtual void end_round(const std::function<void()>& wait) = 0;

  protected:
    [[nodiscard]] std::size_t allocated() const { return shape_.allocated; }

    PoolShape shape_;
    std::size_t batch_count_;
    std::size_t stride_;
    std::size_t camera_capacity_;
    int split_depth_;
    std::size_t total_ = 0;
    Records records_;
};

/// Survivors stay at the front of their batch: nothing moves and nothing is shared, but batches thin out.
template <Features features, class Scalar>
class InPlacePool : public SharedPool<features, Scalar> {
    using Base = SharedPool<features, Scalar>;

  public:
    InPlacePool(std::size_t capacity, std::size_t batch, int split_depth)
        : Base(capacity, batch, split_depth), capacity_(capacity), counts_(this->batch_count_) {}

    [[nodiscard]] std::size_t count(std::int64_t b) const override { return counts_[static_cast<std::size_t>(b)]; }
    [[nodiscard]] std::size_t free_slots(std::int64_t b) const override {
        const bool has_one_more = static_cast<std::size_t>(b) < capacity_ % this->batch_count_;
        const std::size_t share = capacity_ / this->batch_count_ + (has_one_more ? 1 : 0);
        const std::size_t most = share >> static_cast<unsigned>(this->split_depth_);
        return most - std::min(most, count(b));
    }
    std::size_t enqueue(std::int64_t b, std::size_t from, std::size_t front, const typename Base::Records& overflow,
                        std::size_t split) override {
        overflow.copy_to(this->records_, from + front, 0, split);
        const std::size_t end = from + front + split;
        counts_[static_cast<std::size_t>(b)] = end - this->first(b);
        return end;
    }
    void end_round(const std::function<void()>&) override {
#pragma omp single nowait
        {
            this->total_ = 0;
            for (const std::size_t count : counts_) this->total_ += count;
        }
    }

  private:
    std::size_t capacity_;
    std::vector<std::size_t> counts_;
};

/// What the two strategies share that move survivors: the records of a round are dense, and free slots are shared out
/// evenly.
template <Features features, class Scalar>
class DensePool : public SharedPool<features, Scalar> {
  public:
    using SharedPool<features, Scalar>::SharedPool;
    [[nodiscard]] std::size_t count(std::int64_t b) const override {
        return std::min(this->stride_, this->total_ - std::min(this->total_, this->first(b)));
    }
    [[nodiscard]] std::size_t free_slots(std::int64_t b) const override {
        const std::size_t free = this->camera_capacity_ - std::min(this->camera_capacity_, this->total_);
        const bool has_one_more = static_cast<std::size_t>(b) < free % this->batch_count_;
        return free / this->batch_count_ + (has_one_more ? 1 : 0);
    }
};

/// Survivors move to a second pool, to places taken from one counter: one atomic addition a batch.
template <Features features, class Scalar>
class AtomicPool : public DensePool<features, Scalar> {
    using Base = DensePool<features, Scalar>;

  public:
    AtomicPool(std::size_t capacity, std::size_t batch, int split_depth)
        : Base(capacity, batch, split_depth), next_records_(this->allocated()) {}

    std::size_t enqueue(std::int64_t b, std::size_t from, std::size_t front, const typename Base::Records& overflow,
                        std::size_t split) override {
        const std::size_t target = next_.fetch_add(front + split, std::memory_order_relaxed);
        this->records_.copy_to(next_records_, target, from, front);
        overflow.copy_to(next_records_, target + front, 0, split);
        return this->first(b);
    }
    void end_round(const std::function<void()>&) override {
#pragma omp single nowait
        {
            std::swap(this->records_, next_records_);
            this->total_ = next_.exchange(0);
        }
    }

  private:
    typename Base::Records next_records_;
    std::atomic<std::size_t> next_ = 0;
};

/// Survivors collect in a buffer of each thread, whose places in the next round are a prefix sum of their lengths.
template <Features features, class Scalar>
class PrefixSumPool : public DensePool<features, Scalar> {
    using Base = DensePool<features, Scalar>;

  public:
    PrefixSumPool(std::size_t capacity, std::size_t batch, int split_depth, int threads)
        : Base(capacity, batch, split_depth), buffers_(static_cast<std::size_t>(threads)) {
        for (Buffer& buffer : buffers_) buffer.records = std::make_unique<typename Base::Records>(this->allocated());
    }
    std::size_t enqueue(std::int64_t b, std::size_t from, std::size_t front, const typename Base::Records& overflow,
                        std::size_t split) override {
        Buffer& buffer = buffers_[static_cast<std::size_t>(omp_get_thread_num())];
        this->records_.copy_to(*buffer.records, buffer.count, from, front);
        overflow.copy_to(*buffer.records, buffer.count + front, 0, split);
        buffer.count += front + split;
        return this->first(b);
    }
    void end_round(const std::function<void()>& wait) override {
        const auto thread = static_cast<std::size_t>(omp_get_thread_num());
        std::size_t target = 0;
        for (std::size_t i = 0; i < thread; ++i) target += buffers_[i].count;
        buffers_[thread].records->copy_to(this->records_, target, 0, buffers_[thread].count);
        wait();
#pragma omp single nowait
        {
            this->total_ = 0;
            for (Buffer& buffer : buffers_) this->total_ += std::exchange(buffer.count, 0);
        }
    }

  private:
    struct alignas(64) Buffer {
        std::unique_ptr<typename Base::Records> records;
        std::size_t count = 0;
    };
    std::vector<Buffer> buffers_;
};

/// What make_shared_pool() allocates: a pool by its shape; the one that survivors move to; or a buffer of each thread,
/// any of which may have to take them all.
template <Features features, class Scalar>
std::size_t shared_pool_bytes(Append append, const PoolShape& shape, int threads) {
    const std::size_t one = RayColumns<features, Scalar>::bytes(shape.allocated);
    switch (append) {
        case Append::InPlace:
            break;
        case Append::Atomic:
            return 2 * one;
        case Append::PrefixSum:
            return (1 + static_cast<std::size_t>(threads)) * one;
    }
    return one;
}

template <Features features, class Scalar>
std::unique_ptr<SharedPool<features, Scalar>> make_shared_pool(Append append, std::size_t capacity, std::size_t batch,
                                                               int split_depth, int threads) {
    switch (append) {
        case Append::InPlace:
            return std::make_unique<InPlacePool<features, Scalar>>(capacity, batch, split_depth);
        case Append::Atomic:
            return std::make_unique<AtomicPool<features, Scalar>>(capacity, batch, split_depth);
        case Append::PrefixSum:
            return std::make_unique<PrefixSumPool<features, Scalar>>(capacity, batch, split_depth, threads);
    }
    return nullptr;
}

}  // namespace raypool::wavefront
