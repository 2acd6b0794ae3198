#include <mpi.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stop_token>
#include <thread>

#include <fmt/format.h>

#include "cluster/ranks.h"

namespace raypool::cluster {

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr int kAskTag = 1;
constexpr int kAnswerTag = 2;
constexpr std::int64_t kNoneLeft = -1;

/// A message's most elements: MPI counts in int, and a reduction holds a second copy of what is under way.
constexpr std::size_t kChunk = std::size_t{1} << 20;

template <class Element, class Call>
void in_chunks(std::span<Element> values, Call call) {
    for (; !values.empty(); values = values.subspan(std::min(kChunk, values.size())))
        call(values.data(), static_cast<int>(std::min(kChunk, values.size())));
}

/// A rank's question for work, on its way. It is asked before the unit at hand is begun, so that no rank waits for the
/// answer: rank 0's thread may have to wait some milliseconds for a processor, as all of them are at work.
class Question {
  public:
    Question() {
        MPI_Irecv(&answer_, 1, MPI_INT64_T, 0, kAnswerTag, MPI_COMM_WORLD, &receipt_);
        MPI_Send(nullptr, 0, MPI_BYTE, 0, kAskTag, MPI_COMM_WORLD);
    }
    Question(const Question&) = delete;
    Question& operator=(const Question&) = delete;
    std::int64_t answer() {
        MPI_Wait(&receipt_, MPI_STATUS_IGNORE);
        return answer_;
    }

  private:
    std::int64_t answer_ = 0;
    MPI_Request receipt_ = MPI_REQUEST_NULL;
};

/// Answers ranks that ask for work until each has been told that none is left, or until it is stopped.
///
/// A thread of rank 0 does this, because rank 0 computes too: MPI moves only when it is called, and a rank would wait
/// for an answer as long as rank 0 is busy with a unit. A counter in rank 0's memory (MPI_Fetch_and_op) needs no thread
/// where the network or shared memory adds by itself, but over TCP it waits just so, and Open MPI 4 has no one-sided
/// calls over TCP in programs with threads. Messages work everywhere. Meanwhile no other thread of rank 0 calls MPI,
/// so MPI_THREAD_SERIALIZED will do. The thread looks, rather than wait in MPI, which would spin on a processor: often
/// while questions come, seldom when all are at work.
template <class Take>
void answer(int others, const Take& take, const Ranks::Work& given, const std::stop_token& stop) {
    for (Clock::time_point asked = Clock::now(); others > 0 && !stop.stop_requested();) {
        int is_asked = 0;
        MPI_Status status;
        MPI_Iprobe(MPI_ANY_SOURCE, kAskTag, MPI_COMM_WORLD, &is_asked, &status);
        if (is_asked == 0) {
            std::this_thread::sleep_for(std::clamp<Clock::duration>((Clock::now() - asked) / 16, 20us, 1ms));
            continue;
        }
        asked = Clock::now();
        MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, kAskTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        const std::int64_t unit = take();
        MPI_Send(&unit, 1, MPI_INT64_T, status.MPI_SOURCE, kAnswerTag, MPI_COMM_WORLD);
        if (unit == kNoneLeft)
            --others;
        else
            given(unit);
    }
}

class MpiRanks : public Ranks {
  public:
    MpiRanks();
    MpiRanks(const MpiRanks&) = delete;
    MpiRanks& operator=(const MpiRanks&) = delete;
    ~MpiRanks() override { MPI_Finalize(); }
    int fail(int status, const std::string& text) const override;
    void hand_out(std::int64_t count, const Work& work, const Work& given) override;
    void sum_at_first(std::span<std::int64_t> values) override;
    void sum_everywhere(std::span<std::int64_t> values) override;
    [[nodiscard]] std::int64_t greatest(std::int64_t value) override;
    void broadcast(std::span<std::byte> bytes) override;
    [[nodiscard]] std::vector<std::vector<std::byte>> gather(std::span<const std::byte> bytes) override;
};

MpiRanks::MpiRanks() {
    int threads = MPI_THREAD_SINGLE;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &on_this_machine_);
    MPI_Comm_free(&machine);
    if (count_ > 1 && threads < MPI_THREAD_SERIALIZED)
        std::exit(MpiRanks::fail(2, "this MPI was built without threads"));
}

int MpiRanks::fail(int status, const std::string& text) const {
    // What all ranks find wrong, rank 0 says: it ends the job while the others sleep.
    if (!is_first()) std::this_thread::sleep_for(5s);
    fmt::print(stderr, "raypool: {}{}\n", is_first() ? "" : fmt::format("rank {} of {}: ", rank_, count_), text);
    if (count_ > 1) MPI_Abort(MPI_COMM_WORLD, status);
    return status;
}

void MpiRanks::hand_out(std::int64_t count, const Work& work, const Work& given) {
    if (!is_first()) {
        for (std::int64_t unit = Question().answer(); unit != kNoneLeft;) {
            Question next;
            work(unit);
            unit = next.answer();
        }
        return;
    }
    std::atomic<std::int64_t> next = 0;
    const auto take = [&] {
        const std::int64_t unit = next++;
        return unit < count ? unit : kNoneLeft;
    };
    std::jthread clerk([&](const std::stop_token& stop) { answer(count_ - 1, take, given, stop); });
    try {
        for (std::int64_t unit = take(); unit != kNoneLeft; unit = take()) work(unit);
        clerk.join();  // when all have ended
    } catch (...) {
        clerk.request_stop();  // the job ends: a question gets no answer now
        throw;
    }
}

void MpiRanks::sum_at_first(std::span<std::int64_t> values) {
    in_chunks(values, [this](std::int64_t* from, int size) {
        MPI_Reduce(is_first() ? MPI_IN_PLACE : from, is_first() ? from : nullptr, size, MPI_INT64_T, MPI_SUM, 0,
                   MPI_COMM_WORLD);
    });
    if (!is_first()) std::fill(values.begin(), values.end(), 0);
}

void MpiRanks::sum_everywhere(std::span<std::int64_t> values) {
    in_chunks(values, [](std::int64_t* from, int size) {
        MPI_Allreduce(MPI_IN_PLACE, from, size, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    });
}

std::int64_t MpiRanks::greatest(std::int64_t value) {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD);
    return value;
}

void MpiRanks::broadcast(std::span<std::byte> bytes) {
    in_chunks(bytes, [](std::byte* from, int size) { MPI_Bcast(from, size, MPI_BYTE, 0, MPI_COMM_WORLD); });
}

std::vector<std::vector<std::byte>> MpiRanks::gather(std::span<const std::byte> bytes) {
    const int size = static_cast<int>(bytes.size());
    if (!is_first()) {
        MPI_Send(bytes.data(), size, MPI_BYTE, 0, kAnswerTag, MPI_COMM_WORLD);
        return {};
    }
    std::vector<std::vector<std::byte>> all{{bytes.begin(), bytes.end()}};
    for (int rank = 1; rank < count_; ++rank) {
        MPI_Status status;
        MPI_Probe(rank, kAnswerTag, MPI_COMM_WORLD, &status);
        int arriving = 0;
        MPI_Get_count(&status, MPI_BYTE, &arriving);
        all.emplace_back(static_cast<std::size_t>(arriving));
        MPI_Recv(all.back().data(), arriving, MPI_BYTE, rank, kAnswerTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
    return all;
}

}  // namespace

}  // namespace raypool::cluster

extern "C" raypool::cluster::Ranks* raypool_make_ranks() {
    return new raypool::cluster::MpiRanks;
}
