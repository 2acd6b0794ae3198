/// Output files that appear whole or not at all.
///
/// Everything the programs write for a user (images, JSON, CSV) is made in memory and handed to write_whole(), which
/// writes a temporary file in the folder of the target, flushes it to the disk and renames it over the target. A
/// failure removes the temporary and leaves an existing target as it was. What is not a regular file (a device, a
/// pipe, /dev/stdout) is written to directly.
/// Errors are InputErrors that name the file and the system's reason: `out/a.png: cannot write: No space left on
/// device`.
///
/// Exceeding a file size limit or writing to a closed pipe raises a signal before it is an error; a program that wants
/// the error ignores SIGXFSZ and SIGPIPE. Thread-safe, for different targets.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace raypool {

void write_whole(const std::filesystem::path& path, std::span<const std::byte> content);

/// Throws what write_whole() would throw if it can be known beforehand: the folder is absent or read-only, the target
/// is a directory. Called ahead of long work; leaves nothing behind and writes to nothing.
void check_writable(const std::filesystem::path& path);

}  // namespace raypool
