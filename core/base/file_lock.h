/// A lock on a file that is replaced while it is worked on, such as a checkpoint.
///
/// The lock is the system's (flock), on a companion in the file's folder, `.raypool-<digits>.lock`, because each new
/// version of the file is another file to the system. It ends with the process, however that ends; a companion that a
/// killed process leaves behind is empty and locks nothing. In a folder that may not be written to the file itself is
/// locked, as it is then written in place.
///
/// File systems that have no locks (some network file systems) give none: nothing is then refused.
#pragma once

#include <filesystem>

namespace raypool {

class FileLock {
  public:
    /// Of a regular file, there or not, links followed; of a device none. Throws an InputError naming it where another
    /// process, or another FileLock of this one, has it.
    explicit FileLock(const std::filesystem::path& path);
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;
    ~FileLock();

  private:
    /// Returns false where the companion was removed meanwhile.
    bool try_to_lock(const std::filesystem::path& path, const std::filesystem::path& file);
    void close();

    std::filesystem::path companion_;  ///< empty where there is none
    int descriptor_ = -1;
};

}  // namespace raypool
