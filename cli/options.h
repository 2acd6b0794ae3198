/// Options that commands share, and how their texts are read. A text that makes no sense is an InputError naming the
/// option.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/engine.h"

namespace raypool::cli {

enum class Precision : std::uint8_t { Float, Double };

/// static, dynamic or guided, with an optional chunk: "dynamic,4".
LoopSchedule parse_schedule(std::string_view text);
std::string to_string(const LoopSchedule& schedule);

/// pixel, line or tile:N.
Grain parse_grain(std::string_view text);
std::string to_string(const Grain& grain);

struct SampleRange {
    std::int64_t first;
    std::int64_t end;
};
/// "A:B" with 0 <= A < B <= spp.
SampleRange parse_samples(std::string_view text, std::int64_t spp);

/// A whole number below 2^64.
std::uint64_t parse_seed(std::string_view text);

/// Threads as asked for with --threads, or OMP_NUM_THREADS where `asked` is 0. Refuses more than OpenMP would start.
int thread_count(int asked);

/// Refuses an empty text, which a shell makes of a variable that is not set. For CLI::Option::check().
std::string check_file_name(const std::string& text);

/// What OMP_SCHEDULE says, and dynamic where it says nothing: equal lines are not equal work.
LoopSchedule default_schedule();

/// Sets the image's width, and its height so that the shape stays. Refuses what is not in [1, 65536].
void set_width(Scene& scene, std::int64_t width);

}  // namespace raypool::cli
