#include "cli/checkpoint_keeper.h"

#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "cluster/exchange.h"
#include "core/base/error.h"
#include "core/base/output_file.h"
#include "core/base/text.h"

namespace raypool::cli {

std::unique_ptr<FileLock> claim(const CheckpointOptions& options) {
    if (options.file.empty()) return nullptr;
    check_writable(options.file);
    auto lock = std::make_unique<FileLock>(options.file);
    if (!options.is_resumed && std::filesystem::exists(options.file))
        throw InputError(
            fmt::format("{}: is there already; add --resume to go on from it, or remove it", options.file));
    return lock;
}

Checkpoint load_checkpoint(const CheckpointOptions& options, const Checkpoint& wanted, const SampleRange& samples) {
    Checkpoint sums = read_checkpoint(options.file);
    try {
        check_same_render(sums, wanted);
        if (sums.framebuffer.has_halves() && sums.spp != wanted.spp)
            throw InputError(fmt::format("of an adaptive render with --spp {}, by which it chooses samples, not {}",
                                         sums.spp, wanted.spp));
    } catch (const InputError& error) {
        throw InputError(fmt::format("--resume: {}: {}", options.file, error.what()));
    }
    sums.spp = wanted.spp;
    for (const SampleRange& range : sums.ranges)
        if (range.first < samples.first || range.end > samples.end)
            throw InputError(
                fmt::format("--resume: {} holds samples {} to {}, more than the {} to {} of --samples and --spp",
                            options.file, range.first, range.end, samples.first, samples.end));
    for (const std::int32_t count : sums.sample_counts)
        if (count > samples.end || (sums.rounds > 0 && count < 2))
            throw InputError(fmt::format("--resume: {}: a pixel has {} samples", options.file, count));
    return sums;
}

CheckpointKeeper::CheckpointKeeper(const CheckpointOptions& options, Preview* preview, cluster::Ranks& ranks)
    : options_(options),
      preview_(preview),
      has_preview_(ranks.greatest(preview != nullptr ? 1 : 0) != 0),
      ranks_(ranks) {
    if (is_kept()) signals_.emplace();
}

bool CheckpointKeeper::keep(Checkpoint& sums, const std::function<void()>& complete) {
    if (!wants_pieces()) return true;
    // Rank 0 alone says what is due, so that the greatest of all is what it says, unless one is asked to stop.
    const std::chrono::duration<double> since = Clock::now() - written_;
    const bool is_time = is_kept() && ranks_.is_first() && since.count() >= options_.every_s;
    const bool is_looked_at = preview_ != nullptr && preview_->is_due();
    const std::int64_t signal = is_kept() ? StopSignals::received().load() : 0;
    const std::int64_t asked = ranks_.greatest(4 * signal + (is_time ? 2 : 0) + (is_looked_at ? 1 : 0));
    stopped_by_ = static_cast<int>(asked / 4);
    if (asked != 0) {
        complete();
        cluster::gather(ranks_, sums.framebuffer);
        if (stopped_by_ != 0 || (asked & 2) != 0) write(sums);
        if (preview_ != nullptr) preview_->show(sums);
    }
    return stopped_by_ == 0;
}

void CheckpointKeeper::write(Checkpoint& sums) {
    if (ranks_.is_first()) write_checkpoint(options_.file, sums);
    written_ = Clock::now();
    if (ranks_.count() > 1 && ranks_.is_first()) prepare_last_words(sums);
}

void CheckpointKeeper::finish(Checkpoint& sums) {
    cluster::gather(ranks_, sums.framebuffer);
    if (preview_ != nullptr) preview_->show(sums);
    if (!is_kept()) return;
    try {
        write(sums);
    } catch (const InputError&) {
        failure_ = std::current_exception();
    }
}

/// Where a rank dies, mpirun sends SIGTERM to the others and kills them a second later: they cannot end their piece
/// without it. So what can be gone on from is said at once. Where they can, it holds more in the end.
void CheckpointKeeper::prepare_last_words(const Checkpoint& sums) {
    const std::string held = sums.sample_counts.empty() ? fmt::format("{} samples a pixel", sums.sample_count())
                                                        : fmt::format("{} rounds", sums.rounds);
    StopSignals::set_last_words(
        fmt::format("raypool: asked to stop, or a rank has ended; {} holds at least {}: the same command with --resume "
                    "goes on from there\n",
                    printable(options_.file), held));
}

}  // namespace raypool::cli
