/// The processes that `mpirun` started for one render: which of them this one is, and all that they say to each other.
///
/// The only house that knows MPI, and ranks_mpi.cpp its only file that does; a build without MPI has ranks_alone.cpp,
/// where a process is the only one. MPI is begun only where a launcher asks for it: without, the command starts as
/// ever.
///
/// All ranks must call what is collective, in the same order. What one of them throws does not reach the others: main
/// ends the job for all of them (fail()). One rank has nobody to talk to; all of it is then nothing or a copy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace raypool::cluster {

class Ranks {
  public:
    /// Throws InputError where several ranks were started that this build, or this MPI, cannot make one render of.
    Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;
    /// Waits for the others: whoever comes here has no more to say.
    ~Ranks();

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int count() const { return count_; }
    /// Rank 0 alone prints, and writes files.
    [[nodiscard]] bool is_first() const { return rank_ == 0; }
    /// How many of the ranks share this machine's memory.
    [[nodiscard]] int on_this_machine() const { return on_this_machine_; }

    /// Says what went wrong and, where there are other ranks, ends all of them. Returns the status. Not collective.
    int fail(int status, const std::string& text) const;

    using Work = std::function<void(std::int64_t)>;
    /// Calls work(i) for 0 <= i < count, each on one rank, in rising order on demand. Collective; rank 0 returns when
    /// all is done, others when nothing is left. given(i): work that another rank took, said on rank 0 by a thread.
    /// Work must not talk to other ranks.
    void hand_out(std::int64_t count, const Work& work, const Work& given);

    /// Collective: rank 0's `values` become the sums over ranks, and the others' zero.
    void sum_at_first(std::span<std::int64_t> values);
    /// Collective: everybody's become the sums.
    void sum_everywhere(std::span<std::int64_t> values);
    /// Collective: the greatest of all ranks' values.
    [[nodiscard]] std::int64_t greatest(std::int64_t value);
    /// Collective: rank 0's bytes become everybody's.
    void broadcast(std::span<std::byte> bytes);
    /// Collective: what each rank gave, at rank 0; nothing elsewhere. At most 2 GiB a rank.
    [[nodiscard]] std::vector<std::vector<std::byte>> gather(std::span<const std::byte> bytes);

  private:
    int rank_ = 0;
    int count_ = 1;
    int on_this_machine_ = 1;
    bool is_begun_ = false;  ///< MPI
};

}  // namespace raypool::cluster
