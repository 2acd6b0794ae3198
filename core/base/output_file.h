/// Output files that appear whole or not at all, and never cost the only copy of what was to be written.
///
/// Everything the programs write for a user (images, JSON, CSV) is made in memory and handed to write_whole(), which
/// writes a temporary file in the folder of the target, flushes it to the disk, renames it over the target and flushes
/// the folder. Links are followed, also those that lead to no file yet. The new file has the mode, owner and group of
/// the old one; a file that was not there has the mode that the umask leaves. What is not a regular file (a device, a
/// pipe, /dev/stdout) is written to directly.
///
/// A target is written in place, over its old content, where a rename is impossible (a file that is a mount point,
/// another user's in a sticky folder, a folder that may not be written to) or would change more than the content (other
/// names of the file, an owner that cannot be given). A reader may then see a part. The temporary file stays until the
/// target is whole, and room is reserved before anything is written.
///
/// A failure leaves an existing target as it was and removes the temporary file, unless that is the only whole copy: it
/// is then kept, and named. Errors are InputErrors that name the file and the system's reason: `out/a.png: cannot
/// write: No space left on device`.
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

/// The file that a path means, links followed as far as they lead, whether it is there or not.
std::filesystem::path final_file(const std::filesystem::path& path);

}  // namespace raypool
