/// The threads of a GPU, one at a time: warps whose lanes wait for each other where they vote or shuffle. What else
/// they do is in instructions.h.
#pragma once

#include <cstdint>
#include <string>

namespace raypool::ptx {

struct Thread {
    std::uint32_t tid = 0, ntid = 0, ctaid = 0, nctaid = 0;
};
/// The one that runs.
extern Thread thread;

/// A kernel, which its translation makes known before a program begins. It takes pointers to its parameters.
class Kernel {
  public:
    using Run = void (*)(void* const* parameters);
    Kernel(const char* name, Run run);
    void operator()(void* const* parameters) const { run_(parameters); }

  private:
    Run run_;
};
/// The only kernel whose name, as the compiler writes it, has `part` in it.
const Kernel& find_kernel(const std::string& part);

/// Runs blocks of threads, one warp after another. The lanes of a warp run one after another too, up to where they vote
/// or shuffle: there each waits for all that have not ended. Fails a check where some do not come, or come elsewhere.
void run_grid(const Kernel& kernel, void* const* parameters, std::uint32_t blocks, std::uint32_t block_threads);

/// What a lane brings to a vote or a shuffle. Returns once all lanes are there; then brought_by(i) is lane i's value.
struct Meeting {
    std::uint32_t place;  ///< in the program
    std::uint32_t value;
    std::uint32_t mask;
};
void meet(const Meeting& brought);
/// Of the lanes of the warp; those that have ended bring 0.
std::uint32_t brought_by(std::uint32_t lane);
/// Of the lane that runs.
std::uint32_t lane_number();

}  // namespace raypool::ptx
