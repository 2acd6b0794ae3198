/// How much memory there is to be had, so that what asks for more is refused before it begins.
///
/// Linux grants more memory than it has and kills the process that touches it, so that a failed allocation alone does
/// not tell.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace raypool {

/// Bytes that this process can still allocate and touch: the least of what the machine has left (with its swap), what
/// its control groups leave it, and what `ulimit -v` leaves it. The greatest size_t where nothing can be found out.
std::size_t available_memory();

/// Throws InputError unless `bytes` are available: "WHAT take 107.4 GB, of 20.1 GB of memory that are available".
void check_available(std::size_t bytes, std::string_view what);

/// Bytes of the second-level cache of a core; 1 MiB where the system does not say.
std::size_t second_level_cache();

/// "107.4 GB", "20.1 MB": powers of ten.
std::string bytes_text(std::size_t bytes);

/// What limits this process by a control group's files, below `root`, and group `path`: its and its parents' limits
/// less what each has in use already. For tests.
std::size_t control_group_memory(const std::string& root, std::string path, const char* limit_file,
                                 const char* usage_file);

}  // namespace raypool
