/// Cache misses of a render: counted by the processor where it lets us, otherwise by cachegrind, which simulates a
/// cache while it runs the command of a build that valgrind understands.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace raypool::studies {

/// Accesses to data and those of them that missed the first-level and the last-level cache. A processor may not count
/// each of them.
struct CacheCounts {
    std::optional<std::int64_t> reads, writes;
    std::optional<std::int64_t> d1_read_misses, d1_write_misses;
    std::optional<std::int64_t> ll_read_misses, ll_write_misses;
};

/// Counts what the calling thread does in `work`. Nothing where the processor or the system does not let us: `work` is
/// not called then.
std::optional<CacheCounts> count_by_hardware(const std::function<void()>& work);

/// The caches that cachegrind simulates, the same on every machine: 32 KiB and 1 MiB, lines of 64 bytes.
inline constexpr const char* kSimulatedD1 = "32768,8,64";
inline constexpr const char* kSimulatedLl = "1048576,16,64";

/// The counts of cachegrind's file over the functions (demangled names) that `is_wanted`. Throws std::runtime_error
/// for what is no such file.
CacheCounts read_cachegrind(std::istream& file, const std::function<bool(const std::string&)>& is_wanted);

/// What cachegrind can run.
struct CachegrindCommand {
    std::filesystem::path path;  ///< of the raypool command; empty where there is none
    std::string why;             ///< there is none
};
/// This executable, unless it was compiled for AVX-512; then its twin of the preset `portable`, where that is of the
/// same commit. Looked for once.
const CachegrindCommand& cachegrind_command();

struct Cachegrind {
    CacheCounts rendering;     ///< the wavefront engine, without what it does once at the end of a render
    CacheCounts accumulating;  ///< of that, adding contributions to the framebuffer
    CacheCounts all;           ///< the whole command, reading and writing too
    std::int64_t segments = 0;
    std::string hash;
};
/// Runs `raypool render` with these arguments under cachegrind. Throws std::runtime_error where that fails.
Cachegrind run_cachegrind(const std::vector<std::string>& arguments);

}  // namespace raypool::studies
