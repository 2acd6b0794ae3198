#include "core/base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool {

namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

/// The number in a file of one; nothing where there is none, as in "max".
bool read_number(const std::string& path, std::size_t& number) {
    std::ifstream file(path);
    return static_cast<bool>(file >> number);
}

std::size_t machine_memory() {
    std::ifstream file("/proc/meminfo");
    std::size_t bytes = 0;
    bool is_known = false;
    for (std::string line; std::getline(file, line);) {
        std::istringstream fields(line);
        std::string name;
        std::size_t kilobytes = 0;
        fields >> name >> kilobytes;
        if (name == "MemAvailable:") is_known = true;
        if (name == "MemAvailable:" || name == "SwapFree:") bytes += kilobytes * 1024;
    }
    return is_known ? bytes : kUnlimited;
}

/// What `ulimit -v` leaves.
std::size_t address_space() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
    std::size_t pages = 0;
    if (!read_number("/proc/self/statm", pages)) return kUnlimited;
    const std::size_t used = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

std::size_t control_groups() {
    std::ifstream file("/proc/self/cgroup");
    std::size_t least = kUnlimited;
    for (std::string line; std::getline(file, line);) {  // hierarchy:controllers:path
        const std::size_t first = line.find(':');
        const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = fmt::format(",{},", line.substr(first + 1, second - first - 1));
        const std::string path = line.substr(second + 1);
        if (controllers == ",,")
            least = std::min(least, control_group_memory("/sys/fs/cgroup", path, "memory.max", "memory.current"));
        if (controllers.find(",memory,") != std::string::npos)
            least = std::min(least, control_group_memory("/sys/fs/cgroup/memory", path, "memory.limit_in_bytes",
                                                         "memory.usage_in_bytes"));
    }
    return least;
}

/// Bytes of files in the page cache that a control group would give up: counted as in use, but to be had.
std::size_t reclaimable(const std::string& folder) {
    std::ifstream file(folder + "/memory.stat");
    std::string name;
    std::size_t bytes = 0;
    std::size_t own = 0;
    while (file >> name >> bytes) {
        if (name == "total_inactive_file") return bytes;  // version 1: with the groups below, as usage is
        if (name == "inactive_file") own = bytes;
    }
    return own;
}

}  // namespace

std::size_t control_group_memory(const std::string& root, std::string path, const char* limit_file,
                                 const char* usage_file) {
    std::size_t least = kUnlimited;
    while (path.ends_with('/')) path.pop_back();
    for (;;) {
        const std::string folder = root + path;
        std::size_t limit = 0;
        std::size_t used = 0;
        if (read_number(folder + "/" + limit_file, limit) && read_number(folder + "/" + usage_file, used)) {
            used -= std::min(used, reclaimable(folder));
            least = std::min(least, limit > used ? limit - used : 0);
        }
        if (path.empty()) return least;
        path.resize(std::min(path.rfind('/'), path.size() - 1));
    }
}

std::size_t available_memory() {
    return std::min({machine_memory(), address_space(), control_groups()});
}

std::size_t second_level_cache() {
    const long bytes = sysconf(_SC_LEVEL2_CACHE_SIZE);
    return bytes > 0 ? static_cast<std::size_t>(bytes) : std::size_t{1} << 20U;
}

std::string bytes_text(std::size_t bytes) {
    const auto value = static_cast<double>(bytes);
    return bytes < 1'000'000'000 ? fmt::format("{:.1f} MB", value * 1e-6) : fmt::format("{:.1f} GB", value * 1e-9);
}

void check_available(std::size_t bytes, std::string_view what) {
    const std::size_t available = available_memory();
    if (bytes > available)
        throw InputError(fmt::format("{} take {}, of {} of memory that are available", what, bytes_text(bytes),
                                     bytes_text(available)));
}

}  // namespace raypool
