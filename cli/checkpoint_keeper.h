/// What is done between the pieces of a render: a checkpoint every so often, and one when a signal asks to stop; and a
/// look at the image.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "cli/preview.h"
#include "cli/stop_signals.h"
#include "cluster/ranks.h"
#include "core/base/file_lock.h"
#include "core/film/checkpoint.h"

namespace raypool::cli {

struct CheckpointOptions {
    std::string file;  ///< empty: none is kept
    double every_s = 60;
    bool is_resumed = false;
};

/// Refuses (InputError) options that make no sense, a checkpoint that another process is at work on, and one that is
/// there when none is to be resumed. Returns the lock on it, none without a file.
[[nodiscard]] std::unique_ptr<FileLock> claim(const CheckpointOptions& options);

/// What the checkpoint holds, which must be of the same render as `wanted` and have no samples outside of `samples`.
/// More samples may be wanted than the checkpoint was begun for, where that changes no bit of those that it has.
/// InputError names what differs.
Checkpoint load_checkpoint(const CheckpointOptions& options, const Checkpoint& wanted, const SampleRange& samples);

/// Keeps the checkpoint of one render. With a file, signals ask it to stop while it lives (stop_signals.h); a second
/// one ends the program at once, with the last checkpoint whole. Of several ranks, all have one and call it alike:
/// whichever is asked to stop, all do, and the sums go to rank 0, which writes the file and shows the image.
class CheckpointKeeper {
  public:
    /// A preview of rank 0 is a preview of all.
    CheckpointKeeper(const CheckpointOptions& options, Preview* preview, cluster::Ranks& ranks);
    CheckpointKeeper(const CheckpointKeeper&) = delete;
    CheckpointKeeper& operator=(const CheckpointKeeper&) = delete;
    ~CheckpointKeeper() = default;

    /// Whether there is anything to do between pieces; alike on all ranks.
    [[nodiscard]] bool wants_pieces() const { return is_kept() || has_preview_; }
    /// To be asked between pieces of the render: does what is due, after complete() has brought all that was rendered
    /// into `sums`. False when the render shall stop.
    bool keep(Checkpoint& sums, const std::function<void()>& complete);
    /// Gathers the sums of a render that has ended, with a file or without, and writes it. Where that fails, failure()
    /// says why: the sums are there all the same.
    void finish(Checkpoint& sums);
    [[nodiscard]] std::exception_ptr failure() const { return failure_; }

    /// The signal that asked to stop; 0 when none did.
    [[nodiscard]] int stopped_by() const { return stopped_by_; }
    /// Whether what the checkpoint holds was said when the signal came.
    [[nodiscard]] static bool has_said_so() { return StopSignals::has_said_last_words(); }

  private:
    [[nodiscard]] bool is_kept() const { return !options_.file.empty(); }
    void write(Checkpoint& sums);
    void prepare_last_words(const Checkpoint& sums);

    using Clock = std::chrono::steady_clock;
    const CheckpointOptions& options_;
    Preview* preview_;
    bool has_preview_;
    cluster::Ranks& ranks_;
    Clock::time_point written_ = Clock::now();
    std::optional<StopSignals> signals_;
    int stopped_by_ = 0;
    std::exception_ptr failure_;
};

}  // namespace raypool::cli
