#include "tests/gpu/ptx/machine.h"

#include <ucontext.h>

#include <array>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

namespace raypool::ptx {

Thread thread;

namespace {

constexpr std::uint32_t kLanes = 32;
constexpr std::size_t kStackBytes = 1 << 20;

/// The warp that runs: a stack a lane, and who waits for whom.
struct Warp {
    struct Lane {
        ucontext_t context;
        std::unique_ptr<char[]> stack = std::make_unique_for_overwrite<char[]>(kStackBytes);
        bool is_over = true;
        Meeting brought{};
    };
    ucontext_t scheduler{};
    std::array<Lane, kLanes> lanes;
    std::uint32_t running = 0;
    std::array<std::uint32_t, kLanes> values{};  ///< of the last meeting
    const Kernel* kernel = nullptr;
    void* const* parameters = nullptr;
};
Warp warp;

void run_lane() {
    (*warp.kernel)(warp.parameters);
    Warp::Lane& lane = warp.lanes[warp.running];
    lane.is_over = true;
    swapcontext(&lane.context, &warp.scheduler);
}

void start_lane(std::uint32_t number) {
    Warp::Lane& lane = warp.lanes[number];
    getcontext(&lane.context);
    lane.context.uc_stack.ss_sp = lane.stack.get();
    lane.context.uc_stack.ss_size = kStackBytes;
    lane.context.uc_link = nullptr;
    makecontext(&lane.context, run_lane, 0);
    lane.is_over = false;
}

/// Lets every lane go on to its next meeting, or to its end. Returns whether any waits.
bool advance(std::uint32_t first_tid) {
    std::uint32_t living = 0;
    for (std::uint32_t i = 0; i < kLanes; ++i) {
        if (warp.lanes[i].is_over) continue;
        warp.running = i;
        thread.tid = first_tid + i;
        swapcontext(&warp.scheduler, &warp.lanes[i].context);
        if (!warp.lanes[i].is_over) living |= 1U << i;
    }
    warp.values = {};
    const Meeting* first = nullptr;
    for (std::uint32_t i = 0; i < kLanes; ++i) {
        if ((living >> i & 1U) == 0) continue;
        const Meeting& brought = warp.lanes[i].brought;
        if (first == nullptr) first = &brought;
        if (first->place != brought.place || (brought.mask & living) != living)
            throw std::logic_error("the lanes of a warp do not meet");
        warp.values[i] = brought.value;
    }
    return living != 0;
}

std::map<std::string, const Kernel*>& kernels() {
    static std::map<std::string, const Kernel*> all;
    return all;
}

}  // namespace

Kernel::Kernel(const char* name, Run run) : run_(run) {
    kernels()[name] = this;
}

const Kernel& find_kernel(const std::string& part) {
    const Kernel* found = nullptr;
    for (const auto& [name, kernel] : kernels()) {
        if (name.find(part) == std::string::npos) continue;
        if (found != nullptr) throw std::logic_error("several kernels have " + part + " in their names");
        found = kernel;
    }
    if (found == nullptr) throw std::logic_error("no kernel has " + part + " in its name");
    return *found;
}

void meet(const Meeting& brought) {
    Warp::Lane& lane = warp.lanes[warp.running];
    lane.brought = brought;
    swapcontext(&lane.context, &warp.scheduler);
}
std::uint32_t brought_by(std::uint32_t lane) {
    return warp.values[lane];
}
std::uint32_t lane_number() {
    return warp.running;
}

void run_grid(const Kernel& kernel, void* const* parameters, std::uint32_t blocks, std::uint32_t block_threads) {
    warp.kernel = &kernel;
    warp.parameters = parameters;
    thread.ntid = block_threads;
    thread.nctaid = blocks;
    for (thread.ctaid = 0; thread.ctaid < blocks; ++thread.ctaid) {
        for (std::uint32_t first = 0; first < block_threads; first += kLanes) {
            for (std::uint32_t i = 0; i < kLanes && first + i < block_threads; ++i) start_lane(i);
            while (advance(first)) {
            }
        }
    }
}

}  // namespace raypool::ptx
