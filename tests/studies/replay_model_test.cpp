#include "bench/studies/replay_model.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace raypool::studies {
namespace {

using Kind = ReplaySchedule::Kind;

const ReplaySchedule kSchedules[] = {{Kind::Static, 0},  {Kind::Static, 1},       {Kind::Static, 7},
                                     {Kind::Dynamic, 0}, {Kind::Dynamic, 5},      {Kind::Guided, 0},
                                     {Kind::Guided, 4},  {Kind::LongestFirst, 0}, {Kind::Factoring, 0}};
constexpr int kThreads[] = {1, 2, 3, 8, 64, 1000};

/// Costs between 1 and 100, most of them small.
std::vector<double> uneven_items(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<double> items(count);
    for (double& item : items) {
        const double u = std::uniform_real_distribution(0.0, 1.0)(random);
        item = 1 + 99 * u * u * u;
    }
    return items;
}
double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Paths of 1 to 5 segments.
struct Paths {
    std::vector<std::uint32_t> first{0};
    std::vector<float> cost;

    explicit Paths(std::size_t count) {
        std::mt19937 random(5);
        for (std::size_t i = 0; i < count; ++i) {
            const auto length = std::uniform_int_distribution(1, 5)(random);
            for (int s = 0; s < length; ++s)
                cost.push_back(static_cast<float>(std::uniform_int_distribution(1, 50)(random)));
            first.push_back(static_cast<std::uint32_t>(cost.size()));
        }
    }
    [[nodiscard]] SegmentCosts segments() const { return {first, cost}; }
    [[nodiscard]] double total() const { return std::accumulate(cost.begin(), cost.end(), 0.0); }
};

TEST(Replay, EveryItemIsDoneOnceByTheThreadThatIsSaidToOwnIt) {
    const std::vector<double> items = uneven_items(503, 1);
    for (const ReplaySchedule& schedule : kSchedules) {
        for (const int threads : kThreads) {
            const Replayed result = replay(items, schedule, threads);
            std::vector<double> work(static_cast<std::size_t>(threads));
            for (std::size_t i = 0; i < items.size(); ++i) work[static_cast<std::size_t>(result.owner[i])] += items[i];
            for (std::size_t i = 0; i < work.size(); ++i) EXPECT_NEAR(work[i], result.work[i], 1e-9);
            EXPECT_NEAR(result.total(), sum(items), 1e-9);
        }
    }
}

TEST(Replay, IsNeverFasterThanTheBoundNorThanTheBusiestThread) {
    const std::vector<double> items = uneven_items(503, 2);
    for (const ReplaySchedule& schedule : kSchedules) {
        for (const int threads : kThreads) {
            const Replayed result = replay(items, schedule, threads);
            EXPECT_GE(result.makespan, makespan_bound(items, threads) * (1 - 1e-12));
            EXPECT_NEAR(result.makespan, *std::max_element(result.work.begin(), result.work.end()), 1e-9);
            EXPECT_LE(result.efficiency(), 1 + 1e-12);
        }
    }
}

TEST(Replay, OneThreadTakesAsLongAsAllItemsTogether) {
    const std::vector<double> items = uneven_items(100, 3);
    for (const ReplaySchedule& schedule : kSchedules)
        EXPECT_NEAR(replay(items, schedule, 1).makespan, sum(items), 1e-9);
}

TEST(Replay, GivesStaticIterationsToTheThreadsThatOpenMpGivesThemTo) {
    constexpr int kItems = 101;
    const std::vector<double> items(kItems, 1.0);
    for (const int threads : {1, 2, 3, 4, 7}) {
        for (const int chunk : {0, 1, 3, 16}) {
            std::vector<std::int32_t> owner(kItems);
            omp_set_dynamic(0);
            omp_set_schedule(omp_sched_static, chunk);
#pragma omp parallel for num_threads(threads) schedule(runtime)
            for (int i = 0; i < kItems; ++i) owner[static_cast<std::size_t>(i)] = omp_get_thread_num();
            EXPECT_EQ(replay(items, {Kind::Static, chunk}, threads).owner, owner) << threads << " threads, " << chunk;
        }
    }
}

TEST(Replay, CutsGuidedAndFactoredChunksAsTheyAreDefined) {
    // Threads that never come back, but for one: the sizes show.
    const std::vector<double> items(100, 1.0);
    const auto sizes = [&](const ReplaySchedule& schedule) {
        const Replayed result = replay(items, schedule, 4);
        std::vector<int> lengths;
        for (std::size_t i = 0; i < items.size(); ++i) {
            if (i == 0 || result.owner[i] != result.owner[i - 1]) lengths.push_back(0);
            ++lengths.back();
        }
        lengths.resize(3);  // then the thread that took the last is free first
        return lengths;
    };
    EXPECT_EQ(sizes({Kind::Guided, 0}), (std::vector<int>{25, 19, 14}));     // a quarter of what is left
    EXPECT_EQ(sizes({Kind::Factoring, 0}), (std::vector<int>{13, 13, 13}));  // half of it, in four
}

TEST(Replay, LongestFirstComesWithinFourThirdsOfTheBestThereIs) {
    constexpr int kThreads = 3;
    for (unsigned seed = 0; seed < 50; ++seed) {
        const std::vector<double> items = uneven_items(8, seed);
        double best = sum(items);
        for (int code = 0; code < 6561; ++code) {  // every way of giving 8 items to 3 threads
            double load[kThreads] = {};
            for (int rest = code; const double item : items) {
                load[rest % kThreads] += item;
                rest /= kThreads;
            }
            best = std::min(best, *std::max_element(load, load + kThreads));
        }
        EXPECT_LE(replay(items, {Kind::LongestFirst, 0}, kThreads).makespan, 4.0 / 3 * best * (1 + 1e-12));
        EXPECT_GE(best, makespan_bound(items, kThreads) * (1 - 1e-12));
    }
}

TEST(Replay, LetsDynamicChunksGoToWhoIsFreeFirst) {
    const std::vector<double> items{10, 1, 1, 1, 1, 1};
    const Replayed result = replay(items, {Kind::Dynamic, 1}, 2);
    EXPECT_EQ(result.owner, (std::vector<std::int32_t>{0, 1, 1, 1, 1, 1}));
    EXPECT_EQ(result.makespan, 10);
}

TEST(Replay, ChargesAFetchForEachChunkToWhoFetchesIt) {
    const std::vector<double> items(12, 1.0);
    EXPECT_EQ(replay(items, {Kind::Dynamic, 3}, 1, {.fetch = 0.5}).makespan, 12 + 4 * 0.5);
    EXPECT_EQ(replay(items, {Kind::Dynamic, 3}, 2, {.fetch = 0.5}).makespan, 6 + 2 * 0.5);
    EXPECT_EQ(replay(items, {Kind::Static, 3}, 2, {.fetch = 0.5}).makespan, 6);
    // The second thread's first chunk waits for the first one's to be handed out; later they do not meet.
    EXPECT_EQ(replay(items, {Kind::Dynamic, 3}, 2, {.serve = 0.5}).makespan, 6 + 3 * 0.5);
    EXPECT_EQ(replay(items, {Kind::Dynamic, 3}, 2, {.fetch = 0.5}).total(), 12);
}

TEST(Replay, LetsASlowThreadTakeLessWhereItMayAndLongerWhereItMayNot) {
    const std::vector<double> items(300, 1.0);
    const double speeds[] = {1, 0.5};
    EXPECT_EQ(replay(items, {Kind::Static, 0}, 2, {}, speeds).makespan, 300);
    const Replayed dynamic = replay(items, {Kind::Dynamic, 1}, 2, {}, speeds);
    EXPECT_NEAR(dynamic.work[0], 200, 1);
    EXPECT_NEAR(dynamic.makespan, 200, 2);
}

TEST(Replay, OfNothingTakesNoTime) {
    for (const ReplaySchedule& schedule : kSchedules) {
        EXPECT_EQ(replay({}, schedule, 3).makespan, 0);
        EXPECT_EQ(replay({}, schedule, 3).efficiency(), 1);
    }
}

TEST(DrainedRounds, HoldTheNextSegmentOfEveryPathThatIsAlive) {
    // Two paths fill the pool, then the third.
    const std::vector<std::uint32_t> first{0, 1, 4, 6};
    const std::vector<float> cost{1, 10, 20, 30, 100, 200};
    // Before each filling, a round that makes camera rays.
    using Rounds = std::vector<std::vector<double>>;
    EXPECT_EQ(drained_rounds({first, cost}, 2, 1, Packing::Dense),
              (Rounds{{0, 0}, {1, 10}, {20}, {30}, {0}, {100}, {200}}));
    EXPECT_EQ(drained_rounds({first, cost}, 3, 2, Packing::Dense), (Rounds{{0, 0}, {11, 100}, {220}, {30}}));
    EXPECT_EQ(drained_rounds({first, cost}, 3, 2, Packing::InPlace), (Rounds{{0, 0}, {11, 100}, {20, 200}, {30, 0}}));
}

TEST(DrainedRounds, KeepAllWorkAtAnyCapacityAndBatch) {
    const Paths paths(1000);
    for (const std::size_t capacity : {1UL, 7UL, 64UL, 5000UL}) {
        for (const std::size_t batch : {1UL, 16UL, 5000UL}) {
            for (const Packing packing : {Packing::InPlace, Packing::Dense}) {
                double total = 0;
                for (const auto& round : drained_rounds(paths.segments(), capacity, batch, packing))
                    total += sum(round);
                EXPECT_EQ(total, paths.total());
            }
        }
    }
}

TEST(ReplayRounds, PayABarrierForEachAndNeverBeatTheirBound) {
    const Paths paths(1000);
    const auto rounds = drained_rounds(paths.segments(), 200, 8, Packing::InPlace);
    for (const ReplaySchedule& schedule : {ReplaySchedule{Kind::Static, 0}, ReplaySchedule{Kind::Dynamic, 1}}) {
        for (const int threads : kThreads) {
            const Replayed free = replay_rounds(rounds, schedule, threads);
            const Replayed paid = replay_rounds(rounds, schedule, threads, {.barrier = 3});
            EXPECT_NEAR(free.total(), paths.total(), 1e-6);
            EXPECT_GE(free.makespan, makespan_bound(rounds, threads) * (1 - 1e-12));
            EXPECT_NEAR(paid.makespan, free.makespan + 3 * static_cast<double>(rounds.size()), 1e-6);
        }
    }
    EXPECT_NEAR(replay_rounds(rounds, {Kind::Dynamic, 1}, 1).makespan, paths.total(), 1e-6);
}

PoolItems items_of(const std::vector<std::uint32_t>& first_path, std::size_t most_held) {
    return {first_path, std::vector<std::size_t>(first_path.size() - 1, most_held)};
}

TEST(ReplayThreadPools, KeepAllWorkAndItsBounds) {
    const Paths paths(1000);
    std::vector<std::uint32_t> items;
    for (std::uint32_t path = 0; path <= 1000; path += 10) items.push_back(path);
    for (const ReplaySchedule& schedule : {ReplaySchedule{Kind::Static, 1}, ReplaySchedule{Kind::Dynamic, 1}}) {
        for (const std::size_t capacity : {1UL, 50UL, 5000UL}) {
            for (const int threads : kThreads) {
                const Replayed result =
                    replay_thread_pools(paths.segments(), items_of(items, capacity), schedule, threads);
                EXPECT_NEAR(result.total(), paths.total(), 1e-6);
                EXPECT_GE(result.makespan, paths.total() / threads * (1 - 1e-12));
            }
        }
    }
}

TEST(ReplayThreadPools, ShareStaticItemsAsALoopDoes) {
    const Paths paths(1000);
    std::vector<std::uint32_t> items;
    std::vector<double> costs;
    for (std::uint32_t path = 0; path <= 1000; path += 10) items.push_back(path);
    for (std::size_t i = 0; i + 1 < items.size(); ++i)
        costs.push_back(std::accumulate(paths.cost.begin() + paths.first[items[i]],
                                        paths.cost.begin() + paths.first[items[i + 1]], 0.0));
    const Replayed loop = replay(costs, {Kind::Static, 1}, 8);
    const Replayed pools = replay_thread_pools(paths.segments(), items_of(items, 64), {Kind::Static, 1}, 8);
    EXPECT_EQ(loop.owner, pools.owner);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(loop.work[i], pools.work[i], 1e-6);
}

TEST(ReplayThreadPools, OfMoreRoomThanThereIsWorkCannotBalanceWhatTheyHold) {
    // The first item is dear, but only its later segments are; by then all items are in somebody's hands.
    const std::vector<std::uint32_t> first{0, 2, 3, 4, 5};
    const std::vector<float> cost{1, 100, 1, 1, 1};
    const std::vector<std::uint32_t> items{0, 1, 2, 3, 4};
    const Replayed result = replay_thread_pools({first, cost}, items_of(items, 1000), {Kind::Dynamic, 1}, 2);
    EXPECT_EQ(result.owner, (std::vector<std::int32_t>{0, 1, 0, 1}));
    EXPECT_EQ(result.makespan, 102);
    // A thread that may hold one path only leaves the later ones to the other.
    const PoolItems one_held = items_of(items, 1);
    EXPECT_EQ(replay_thread_pools({first, cost}, one_held, {Kind::Dynamic, 1}, 2).makespan, 102);
    const double speeds[] = {0.5, 1};
    EXPECT_EQ(replay_thread_pools({first, cost}, one_held, {Kind::Dynamic, 1}, 2, {}, speeds).makespan, 204);
}

TEST(ReplaySharedPool, KeepsAllWorkAndPaysABarrierForEachRound) {
    const Paths paths(1000);
    for (const std::size_t capacity : {1UL, 50UL, 200UL, 5000UL}) {
        for (const std::size_t batch : {1UL, 8UL, 5000UL}) {
            for (const int threads : kThreads) {
                const Replayed result = replay_shared_pool(paths.segments(), capacity, batch, threads);
                EXPECT_NEAR(result.total(), paths.total(), 1e-6);
                EXPECT_GE(result.makespan, paths.total() / threads * (1 - 1e-12));
                EXPECT_GT(replay_shared_pool(paths.segments(), capacity, batch, threads, {.barrier = 1}).makespan,
                          result.makespan + 1);
            }
        }
    }
}

TEST(ReplaySharedPool, FinishesItsBatchesOnceThereAreNoCameraPathsLeft) {
    // Two batches of one path each; the first round takes both paths by a segment, the second one finishes them.
    const std::vector<std::uint32_t> first{0, 3, 5};
    const std::vector<float> cost{1, 10, 20, 2, 5};
    EXPECT_EQ(replay_shared_pool({first, cost}, 2, 1, 2).makespan, 2 + 30);
    EXPECT_EQ(replay_shared_pool({first, cost}, 2, 1, 1).makespan, 38);
    EXPECT_EQ(replay_shared_pool({first, cost}, 2, 1, 1, {.barrier = 3}).makespan, 38 + 2 * 3);
}

}  // namespace
}  // namespace raypool::studies
