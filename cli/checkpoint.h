/// Renders that outlive what happens to them: a checkpoint every so often, and one when a signal asks to stop.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "cluster/ranks.h"
#include "core/sums_file.h"

namespace raypool::cli {

struct CheckpointOptions {
    std::string file;  ///< empty: none is kept
    double every_s = 60;
    bool is_resumed = false;
};

/// Refuses (InputError) options that make no sense, and a checkpoint that is there when none is to be resumed.
void check(const CheckpointOptions& options);

/// What the checkpoint holds, which must be of the same render as `wanted` and have no samples outside of `samples`.
/// InputError names what differs.
RenderSums load_checkpoint(const CheckpointOptions& options, const RenderSums& wanted, const SampleRange& samples);

/// Keeps the checkpoint of one render. With a file, SIGINT and SIGTERM ask it to stop while it lives; a second signal
/// ends the program at once, with the last checkpoint whole. Of several ranks, all have one and call it alike:
/// whichever is asked to stop, all do, and the sums go to rank 0, which writes the file.
class Checkpoint {
  public:
    Checkpoint(const CheckpointOptions& options, cluster::Ranks& ranks);
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;
    ~Checkpoint();

    [[nodiscard]] bool is_kept() const { return !options_.file.empty(); }
    /// To be asked between pieces of the render: writes the file if it is time to, after complete() has brought all
    /// that was rendered into `sums`. False when the render shall stop.
    bool keep(RenderSums& sums, const std::function<void()>& complete);
    /// Gathers the sums, with a file or without, and writes it now.
    void write(RenderSums& sums);

    /// The signal that asked to stop; 0 when none did.
    [[nodiscard]] int stopped_by() const;

  private:
    void prepare_last_words(const RenderSums& sums);

    using Clock = std::chrono::steady_clock;
    const CheckpointOptions& options_;
    cluster::Ranks& ranks_;
    Clock::time_point written_ = Clock::now();
};

}  // namespace raypool::cli
