#include "cli/checkpoint.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "cluster/exchange.h"
#include "core/error.h"
#include "core/output_file.h"
#include "core/text.h"

namespace raypool::cli {

namespace {

std::atomic<int> stop_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

/// Where a rank dies, mpirun sends SIGTERM to the others and kills them a second later: they cannot end their piece
/// without it. So what can be gone on from is said at once.
std::atomic<const std::string*> last_words = nullptr;
static_assert(std::atomic<const std::string*>::is_always_lock_free);

void ask_to_stop(int signal) {
    stop_signal = signal;
    if (const std::string* words = last_words)
        (void)!write(STDERR_FILENO, words->data(), words->size());  // all that a signal handler may do
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

void check(const CheckpointOptions& options) {
    if (options.file.empty()) return;
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

Checkpoint::Checkpoint(const CheckpointOptions& options, cluster::Ranks& ranks) : options_(options), ranks_(ranks) {
    if (options.file.empty()) return;
    stop_signal = 0;
    std::signal(SIGINT, ask_to_stop);
    std::signal(SIGTERM, ask_to_stop);
}
Checkpoint::~Checkpoint() {
    if (!is_kept()) return;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    last_words = nullptr;
}

bool Checkpoint::keep(RenderSums& sums) {
    if (!is_kept()) return true;
    const std::chrono::duration<double> since = Clock::now() - written_;
    const std::int64_t asked = ranks_.greatest(2 * stop_signal + (since.count() >= options_.every_s ? 1 : 0));
    if (asked != 0) write(sums);
    if (asked < 2) return true;
    stop_signal = static_cast<int>(asked / 2);
    return false;
}

void Checkpoint::write(RenderSums& sums) {
    cluster::gather(ranks_, sums.framebuffer);
    if (!is_kept()) return;
    if (ranks_.is_first()) write_sums(options_.file, sums);
    written_ = Clock::now();
    if (ranks_.count() > 1 && ranks_.is_first()) prepare_last_words(sums);
}

void Checkpoint::prepare_last_words(const RenderSums& sums) {
    static std::array<std::string, 2> words;  // one of them may be under a signal handler's eyes
    std::string& next = words[last_words == words.data() ? 1 : 0];
    const std::string held = sums.sample_counts.empty() ? fmt::format("{} samples a pixel", sums.sample_count())
                                                        : fmt::format("{} rounds", sums.rounds);
    next = fmt::format(
        "raypool: asked to stop, or a rank has ended; {} holds {}: the same command with --resume goes on from there\n",
        printable(options_.file), held);
    last_words = &next;
}

int Checkpoint::stopped_by() const {
    return !is_kept() ? 0 : stop_signal.load();
}

}  // namespace raypool::cli
