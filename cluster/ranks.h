/// The processes that `mpirun` started for one render: which of them this one is, and all that they say to each other.
///
/// A Ranks is one rank, which has no other to talk to; what it is asked to do is then nothing, or a copy. The real ones
/// are in ranks_mpi.cpp, the only file that knows MPI. It is built where CMake finds MPI, as a module that is loaded
/// where a launcher has started the command: without one, the command starts as fast as if there were no MPI.
///
/// All ranks must call what is collective, in the same order. The first such call is agree() (agreement.h).
/// What one of them throws does not reach the others: main ends the job for all of them (fail()).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace raypool::cluster {

class Ranks {
  public:
    Ranks() = default;
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;
    /// Waits until every rank has called it; a rank sends nothing afterwards.
    virtual ~Ranks() = default;

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int count() const { return count_; }
    /// Rank 0 alone prints, and writes files.
    [[nodiscard]] bool is_first() const { return rank_ == 0; }
    /// How many of the ranks share this machine's memory.
    [[nodiscard]] int on_this_machine() const { return on_this_machine_; }
    /// How many processes were started alike, this one among them, that know nothing of each other: srun without MPI.
    [[nodiscard]] int separate_count() const { return separate_count_; }
    void set_separate_count(int count) { separate_count_ = count; }
    /// All ranks have said that they are about to do the same (agreement.h).
    [[nodiscard]] bool has_agreed() const { return has_agreed_; }
    void set_agreed() { has_agreed_ = true; }

    /// Says what went wrong and, where there are other ranks, ends all of them. Returns the status. Not collective.
    virtual int fail(int status, const std::string& text) const {
        std::fprintf(stderr, "raypool: %s\n", text.c_str());
        return status;
    }

    using Work = std::function<void(std::int64_t)>;
    /// Calls work(i) for 0 <= i < count, each on one rank, in rising order on demand. Collective; rank 0 returns when
    /// all is done, others when nothing is left. given(i): work that another rank took, said on rank 0 by a thread.
    /// Work must not talk to other ranks.
    virtual void hand_out(std::int64_t count, const Work& work, const Work& /*given*/) {
        for (std::int64_t i = 0; i < count; ++i) work(i);
    }

    /// Collective: rank 0's `values` become the sums over ranks, and the others' zero.
    virtual void sum_at_first(std::span<std::int64_t> /*values*/) {}
    /// Collective: everybody's become the sums.
    virtual void sum_everywhere(std::span<std::int64_t> /*values*/) {}
    /// Collective: the greatest of all ranks' values.
    [[nodiscard]] virtual std::int64_t greatest(std::int64_t value) { return value; }
    /// Collective: rank 0's bytes become everybody's.
    virtual void broadcast(std::span<std::byte> /*bytes*/) {}
    /// Collective: what each rank gave, at rank 0; nothing elsewhere. At most 2 GiB a rank.
    [[nodiscard]] virtual std::vector<std::vector<std::byte>> gather(std::span<const std::byte> bytes) {
        return {{bytes.begin(), bytes.end()}};
    }

  protected:
    int rank_ = 0;
    int count_ = 1;
    int on_this_machine_ = 1;
    int separate_count_ = 1;

  private:
    bool has_agreed_ = false;
};

/// Joins the ranks of a launcher; one rank where none has started this process. Throws InputError where several were
/// started that cannot make one render, because MPI was not there to build with, or has gone.
std::unique_ptr<Ranks> join_ranks();

}  // namespace raypool::cluster
