#include "core/base/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/base/output_file.h"

namespace raypool {

namespace {

namespace fs = std::filesystem;

/// Short, however long the file's own name is.
fs::path companion_of(const fs::path& file) {
    const std::string name = file.filename().string();
    return file.parent_path() / fmt::format(".raypool-{:016x}.lock", XXH3_64bits(name.data(), name.size()));
}

/// Another user's companion, left behind, may not be writable, which a lock does not need.
int open_companion(const fs::path& companion) {
    const int descriptor = ::open(companion.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    return descriptor >= 0 ? descriptor : ::open(companion.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
}

}  // namespace

FileLock::FileLock(const fs::path& path) {
    std::error_code ignored;
    const fs::path file = final_file(path);
    if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) return;
    while (!try_to_lock(path, file)) {
    }
}

bool FileLock::try_to_lock(const fs::path& path, const fs::path& file) {
    companion_ = companion_of(file);
    descriptor_ = open_companion(companion_);
    if (descriptor_ < 0) {
        companion_.clear();
        descriptor_ = ::open(file.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC);
    }
    if (descriptor_ < 0) return true;
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        const bool is_taken = errno == EWOULDBLOCK;
        close();
        if (is_taken) throw InputError(fmt::format("{}: another raypool is at work on it", path.string()));
        companion_.clear();  // there are no locks
        return true;
    }
    if (companion_.empty()) return true;
    // The process that had it before may have removed the companion between open() and flock().
    struct stat open_file {};
    struct stat named {};
    if (::fstat(descriptor_, &open_file) == 0 && ::stat(companion_.c_str(), &named) == 0 &&
        open_file.st_dev == named.st_dev && open_file.st_ino == named.st_ino)
        return true;
    close();
    return false;
}

void FileLock::close() {
    ::close(std::exchange(descriptor_, -1));
}

FileLock::~FileLock() {
    if (descriptor_ < 0) return;
    if (!companion_.empty()) ::unlink(companion_.c_str());
    close();
}

}  // namespace raypool
