#include "bench/studies/peak_memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace raypool::studies {

namespace {

/// A line of /proc/self/status, "VmRSS:    1234 kB".
std::optional<std::size_t> status_bytes(const std::string& name) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::size_t kilobytes = 0;
        if (word == name && status >> kilobytes) return 1024 * kilobytes;
    }
    return std::nullopt;
}

bool forget_peak() {
    std::ofstream references("/proc/self/clear_refs");
    references << "5" << std::flush;  // proc(5): resets VmHWM to VmRSS
    return references.good();
}

}  // namespace

std::optional<std::size_t> peak_growth(const std::function<void()>& work) {
    malloc_trim(0);  // what the allocator keeps of earlier work would hide as much of this
    const bool is_known = forget_peak();
    const std::optional<std::size_t> before = status_bytes("VmRSS:");
    work();
    const std::optional<std::size_t> peak = status_bytes("VmHWM:");
    if (!is_known || !before || !peak) return std::nullopt;
    return *peak > *before ? *peak - *before : 0;
}

}  // namespace raypool::studies
