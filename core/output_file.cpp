#include "core/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
    throw InputError(fmt::format("{}: cannot write: {}", path.string(), std::generic_category().message(error)));
}

/// An open file that is removed again unless rename_to() succeeded. Its name does not contain the target's, which may
/// already be as long as a name can be.
class TemporaryFile {
  public:
    TemporaryFile(const fs::path& folder, const fs::path& target) : target_(target) {
        static std::atomic<unsigned> count{0};
        do {
            name_ = folder / fmt::format(".raypool-{}-{}.tmp", ::getpid(), count++);
            descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
        if (descriptor_ < 0) fail(target_, errno);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!name_.empty()) ::unlink(name_.c_str());
    }

    int descriptor() const { return descriptor_; }

    void rename_to(const fs::path& final_name) {
        if (::fsync(descriptor_) != 0) fail(target_, errno);
        if (::close(std::exchange(descriptor_, -1)) != 0) fail(target_, errno);
        if (std::rename(name_.c_str(), final_name.c_str()) != 0) fail(target_, errno);
        name_.clear();
    }

  private:
    const fs::path& target_;  // as the user wrote it
    fs::path name_;
    int descriptor_ = -1;
};

void write_all(int descriptor, std::span<const std::byte> content, const fs::path& path) {
    while (!content.empty()) {
        const ssize_t written = ::write(descriptor, content.data(), content.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail(path, errno);
        content = content.subspan(static_cast<std::size_t>(written));
    }
}

/// How to reach the file that `path` means.
struct Target {
    enum class Kind { Replace, Direct, OpenDescriptor };
    Kind kind = Kind::Replace;
    fs::path file;        ///< Replace: the name to rename to, links followed, so that a link stays a link
    int descriptor = -1;  ///< OpenDescriptor

    fs::path folder() const { return file.has_parent_path() ? file.parent_path() : fs::path("."); }
};

Target find_target(const fs::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        if (errno != ENOENT || !path.has_filename()) fail(path, errno);
        return {Target::Kind::Replace, path, -1};
    }
    if (S_ISDIR(status.st_mode)) fail(path, EISDIR);

    // /dev/stdout may lead to a regular file. To replace that file would lose what else goes to standard output.
    for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
        struct stat open_file {};
        if (::fstat(descriptor, &open_file) == 0 && open_file.st_dev == status.st_dev &&
            open_file.st_ino == status.st_ino) {
            return {Target::Kind::OpenDescriptor, {}, descriptor};
        }
    }

    // Renaming over a file asks for rights on its folder only; a write-protected file is left alone all the same.
    if (::access(path.c_str(), W_OK) != 0) fail(path, errno);
    if (!S_ISREG(status.st_mode)) return {Target::Kind::Direct, {}, -1};
    std::error_code error;
    const fs::path file = fs::canonical(path, error);
    if (error) fail(path, error.value());
    return {Target::Kind::Replace, file, -1};
}

void write_directly(const fs::path& path, std::span<const std::byte> content) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor < 0) fail(path, errno);
    try {
        write_all(descriptor, content, path);
    } catch (...) {
        ::close(descriptor);
        throw;
    }
    if (::close(descriptor) != 0) fail(path, errno);
}

}  // namespace

void write_whole(const fs::path& path, std::span<const std::byte> content) {
    const Target target = find_target(path);
    switch (target.kind) {
        case Target::Kind::OpenDescriptor:
            write_all(target.descriptor, content, path);
            return;
        case Target::Kind::Direct:
            write_directly(path, content);
            return;
        case Target::Kind::Replace:
            TemporaryFile temporary(target.folder(), path);
            write_all(temporary.descriptor(), content, path);
            temporary.rename_to(target.file);
            return;
    }
}

void check_writable(const fs::path& path) {
    const Target target = find_target(path);
    if (target.kind == Target::Kind::Replace) TemporaryFile(target.folder(), path);
}

}  // namespace raypool
