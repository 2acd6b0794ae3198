#include "cli/checkpoint.h"

#include <atomic>
#include <csignal>
#include <filesystem>

#include <fmt/format.h>

#include "core/error.h"
#include "core/output_file.h"

namespace raypool::cli {

namespace {

std::atomic<int> stop_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

void ask_to_stop(int signal) {
    stop_signal = signal;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

void check(const CheckpointOptions& options) {
    if (options.file.empty()) {
        if (options.is_resumed) throw InputError("--resume: needs --checkpoint FILE, the file to go on from");
        return;
    }
    check_writable(options.file);
    if (!options.is_resumed && std::filesystem::exists(options.file))
        throw InputError(
            fmt::format("{}: is there already; add --resume to go on from it, or remove it", options.file));
}

RenderSums load_checkpoint(const CheckpointOptions& options, const RenderSums& wanted, const SampleRange& samples) {
    RenderSums sums = read_sums(options.file);
    try {
        check_same_render(sums, wanted);
    } catch (const InputError& error) {
        throw InputError(fmt::format("--resume: {}: {}", options.file, error.what()));
    }
    for (const SampleRange& range : sums.ranges)
        if (range.first < samples.first || range.end > samples.end)
            throw InputError(fmt::format("--resume: {} holds samples {} to {}, which are not of --samples {}:{}",
                                         options.file, range.first, range.end, samples.first, samples.end));
    for (const std::int32_t count : sums.sample_counts)
        if (count > samples.end || (sums.rounds > 0 && count < 2))
            throw InputError(fmt::format("--resume: {}: a pixel has {} samples", options.file, count));
    return sums;
}

Checkpoint::Checkpoint(const CheckpointOptions& options) : options_(options) {
    if (options.file.empty()) return;
    stop_signal = 0;
    std::signal(SIGINT, ask_to_stop);
    std::signal(SIGTERM, ask_to_stop);
}
Checkpoint::~Checkpoint() {
    if (!is_kept()) return;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

bool Checkpoint::keep(const RenderSums& sums) {
    if (!is_kept()) return true;
    const std::chrono::duration<double> since = Clock::now() - written_;
    if (stop_signal != 0 || since.count() >= options_.every_s) write(sums);
    return stop_signal == 0;
}

void Checkpoint::write(const RenderSums& sums) {
    if (!is_kept()) return;
    write_sums(options_.file, sums);
    written_ = Clock::now();
}

int Checkpoint::stopped_by() const {
    return !is_kept() ? 0 : stop_signal.load();
}

}  // namespace raypool::cli
