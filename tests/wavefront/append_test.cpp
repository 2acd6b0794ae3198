/// Every strategy for survivors: over many rounds no record is lost, doubled or mixed up, and the pool stays within its
/// capacity. Records here are not rays: each has a fate, known from its numbers, that a recursion can tell beforehand.
#include "wavefront/append.h"

#include <omp.h>

#include <array>
#include <bit>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::wavefront {
namespace {

using test::RandomInputs;

constexpr Features kFeatures{};
using Records = RayColumns<kFeatures, float>;
using Record = RayRecord<float>;

struct Case {
    std::size_t capacity;
    std::size_t batch;
    int split_depth;
};
constexpr Case kCases[] = {{1, 1, 0}, {15, 4, 0}, {17, 16, 0}, {1000, 100, 0}, {700, 16, 0},   {1000, 1000, 0},
                           {4, 4, 2}, {5, 4, 2},  {65, 1, 6},  {129, 128, 7},  {1000, 300, 5}, {1000, 16, 3}};

/// What becomes of a record: a number for each hop, and 0, 1 or 2 records.
std::uint64_t number_of(std::uint32_t path, std::uint32_t branch, std::uint32_t hop) {
    return RandomInputs((std::uint64_t{path} << 32U) + (std::uint64_t{branch} << 16U) + hop).bits();
}
constexpr std::uint32_t kMostHops = 12;
int children(std::uint32_t path, std::uint32_t branch, std::uint32_t hop, int split_depth) {
    const std::uint64_t number = number_of(path, branch, hop);
    const bool may_split = static_cast<int>(std::bit_width(branch + 1)) <= split_depth;
    if (may_split && path % 3 == 0) return 2;  // as often as it can be: so grows a pool to its most
    if (number % 4 == 0 || hop == kMostHops) return 0;
    return may_split && number % 4 == 1 ? 2 : 1;
}

/// The sum of the numbers of the ends of a path.
std::uint64_t ends_of(std::uint32_t path, std::uint32_t branch, std::uint32_t hop, int split_depth) {
    const int count = children(path, branch, hop, split_depth);
    if (count == 0) return number_of(path, branch, hop);
    if (count == 1) return ends_of(path, branch, hop + 1, split_depth);
    return ends_of(path, 2 * branch + 1, hop + 1, split_depth) + ends_of(path, 2 * branch + 2, hop + 1, split_depth);
}

struct Outcome {
    std::vector<std::uint64_t> ends;  ///< by path
    std::size_t most_records = 0;
    bool is_within_batches = true;
    bool is_mixed_up = false;
};

/// The loop of render_shared_pool(), with fates in place of light.
class Rounds {
  public:
    Rounds(Append append, const Case& test, int threads, Refill refill, CameraStage stage, std::uint32_t paths)
        : test_(test),
          threads_(threads),
          refill_(refill),
          stage_(stage),
          pool_(make_shared_pool<kFeatures, float>(append, test.capacity, test.batch, test.split_depth, threads)),
          camera_(paths) {
        outcome_.ends.resize(paths);
    }

    Outcome run() {
#pragma omp parallel num_threads(threads_)
        {
            Worker worker{*this, Records(pool_->batch()), 0};
            for (bool is_done = false; !is_done;) {
                const bool takes_camera = pool_->is_empty() || refill_ == Refill::Regenerate;
#pragma omp for schedule(dynamic) nowait
                for (std::int64_t b = 0; b < pool_->batch_count(); ++b) worker.treat(b, takes_camera);
#pragma omp barrier
                pool_->end_round([] {
#pragma omp barrier
                });
#pragma omp barrier
                is_done = pool_->is_empty() && camera_.is_done();
#pragma omp single
                check_counts();
            }
        }
        return std::move(outcome_);
    }

  private:
    struct Worker {
        Rounds& rounds;
        Records overflow;
        std::size_t overflow_count;

        void treat(std::int64_t b, bool takes_camera) {
            SharedPool<kFeatures, float>& pool = *rounds.pool_;
            Records& records = pool.records();
            std::size_t survivors = 0;
            for (std::size_t i = 0; i < pool.count(b); ++i)
                survivors += advance(records.load<float>(pool.first(b) + i), records, pool.first(b) + survivors);
            std::size_t end = pool.enqueue(b, pool.first(b), survivors, overflow, std::exchange(overflow_count, 0));

            for (std::size_t free_slots = takes_camera ? pool.free_slots(b) : 0; free_slots > 0;) {
                const PathCounter::Part part = rounds.camera_.take(std::min<std::size_t>(free_slots, 64));
                if (part.count == 0) break;
                std::size_t made = 0;
                for (std::int64_t i = 0; i < part.count; ++i) {
                    const auto path = static_cast<std::uint32_t>(part.begin + i);
                    Record record{};
                    record.key = {path, 0};
                    record.throughput[1] = mark_of(path);
                    if (rounds.stage_ == CameraStage::Fused) {
                        made += advance(record, records, end + made);
                    } else {
                        records.append<float>(end + made, record, 1, end + made + 1);
                        ++made;
                    }
                }
                free_slots -= std::min(free_slots, made + overflow_count);
                end = pool.enqueue(b, end, made, overflow, std::exchange(overflow_count, 0));
                if (end > pool.first(b) + pool.batch()) std::atomic_ref(rounds.outcome_.is_within_batches) = false;
            }
        }
        std::size_t advance(Record record, Records& records, std::size_t target) {
            const std::uint32_t path = record.key.pixel;
            if (record.throughput[1] != mark_of(path)) {
                std::atomic_ref(rounds.outcome_.is_mixed_up) = true;
                return 0;
            }
            const int count = children(path, record.step, record.key.sample, rounds.test_.split_depth);
            if (count == 0)
                std::atomic_ref(rounds.outcome_.ends[path]) += number_of(path, record.step, record.key.sample);
            ++record.key.sample;
            if (count == 2) {
                Record other = record;
                other.step = 2 * record.step + 2;
                overflow.append<float>(overflow_count, other, 1, overflow_count + 1);
                ++overflow_count;
                record.step = 2 * record.step + 1;
            }
            if (count == 0) return 0;
            records.append<float>(target, record, 1, target + 1);
            return 1;
        }
        static float mark_of(std::uint32_t path) { return 1000 - static_cast<float>(path); }
    };

    void check_counts() {
        std::size_t total = 0;
        for (std::int64_t b = 0; b < pool_->batch_count(); ++b) {
            total += pool_->count(b);
            if (pool_->count(b) > pool_->batch()) outcome_.is_within_batches = false;
        }
        outcome_.most_records = std::max(outcome_.most_records, total);
    }

    Case test_;
    int threads_;
    Refill refill_;
    CameraStage stage_;
    std::unique_ptr<SharedPool<kFeatures, float>> pool_;
    PathCounter camera_;
    Outcome outcome_;
};

class AppendStrategy : public testing::TestWithParam<std::tuple<Append, int>> {
  protected:
    static void check(const Case& test, Refill refill, CameraStage stage) {
        const auto [append, threads] = GetParam();
        SCOPED_TRACE(fmt::format("capacity {}, batch {}, split depth {}", test.capacity, test.batch, test.split_depth));
        const std::size_t paths_at_a_time = test.capacity >> static_cast<unsigned>(test.split_depth);
        const std::size_t paths = 4 * paths_at_a_time + 20;
        const Outcome got = Rounds(append, test, threads, refill, stage, static_cast<std::uint32_t>(paths)).run();
        EXPECT_FALSE(got.is_mixed_up) << "fields of a record came from two";
        EXPECT_TRUE(got.is_within_batches);
        EXPECT_LE(got.most_records, test.capacity);
        if (stage == CameraStage::Staged) {
            EXPECT_GE(got.most_records, paths_at_a_time) << "room is left unused";
        }
        for (std::uint32_t path = 0; path < paths; ++path)
            ASSERT_EQ(got.ends[path], ends_of(path, 0, 0, test.split_depth)) << "path " << path;
    }
};

TEST_P(AppendStrategy, BringsEveryRecordToItsEndWhenPathsEnterTheEmptyPool) {
    for (const Case& test : kCases) check(test, Refill::Drain, CameraStage::Staged);
}
TEST_P(AppendStrategy, BringsEveryRecordToItsEndWhenPathsEnterWhereThereIsRoom) {
    for (const Case& test : kCases) check(test, Refill::Regenerate, CameraStage::Staged);
}
TEST_P(AppendStrategy, BringsEveryRecordToItsEndWhenPathsEnterAfterTheirFirstHop) {
    for (const Case& test : kCases) check(test, Refill::Regenerate, CameraStage::Fused);
}

INSTANTIATE_TEST_SUITE_P(Strategies, AppendStrategy,
                         testing::Combine(testing::Values(Append::InPlace, Append::Atomic, Append::PrefixSum),
                                          testing::Values(1, 2, 3, 7)));

TEST(PathCounter, HandsEachPathToOneThread) {
    constexpr std::int64_t kPaths = 10'000;
    PathCounter counter(kPaths);
    std::vector<int> taken(kPaths, 0);
#pragma omp parallel num_threads(4)
    {
        for (std::size_t most = 1;; most = most % 70 + 1) {
            const PathCounter::Part part = counter.take(most);
            if (part.count == 0) break;
            for (std::int64_t i = 0; i < part.count; ++i)
                ++std::atomic_ref(taken[static_cast<std::size_t>(part.begin + i)]);
        }
    }
    EXPECT_TRUE(counter.is_done());
    EXPECT_EQ(taken, std::vector<int>(kPaths, 1));
}

}  // namespace
}  // namespace raypool::wavefront
