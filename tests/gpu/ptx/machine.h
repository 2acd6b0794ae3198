/// The threads of a GPU, one at a time: warps whose lanes wait for each other where they vote or shuffle. What else they
/// do is in instructions.h.
#pragma once

#include <cstdint>
#include <vector>

namespace raypool::ptx {

struct Thread {
    std::uint32_t tid = 0, ntid = 0, ctaid = 0, nctaid = 0;
};
/// The one that runs.
extern Thread thread;

/// A kernel by the numbers in its name; its parameter is a Launch.
struct Entry {
    int features;
    int kernel;
    void (*run)(const std::uint8_t* parameter);
};
extern const std::vector<Entry> kEntries;

/// Runs blocks of threads, one warp after another. The lanes of a warp run one after another too, up to where they vote
/// or shuffle: there each waits for all that have not ended. Fails a check where some do not come, or come elsewhere.
void run_grid(const Entry& entry, const std::uint8_t* parameter, std::uint32_t blocks, std::uint32_t block_threads);

/// What a lane brings to a vote or a shuffle. Returns once all lanes are there; then brought_by(i) is lane i's value.
struct Meeting {
    const char* name;
    std::uint32_t value;
    std::uint32_t mask;
};
void meet(const Meeting& brought);
/// Of the lanes of the warp; those that have ended bring 0.
std::uint32_t brought_by(std::uint32_t lane);

}  // namespace raypool::ptx
