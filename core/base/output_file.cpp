#include "core/base/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>

#include "core/base/error.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using ByteSpan = std::span<const std::byte>;

/// `kept`: a file that holds what was to be written.
[[noreturn]] void fail(const fs::path& path, int error, const fs::path& kept = {}) {
    throw InputError(fmt::format("{}: cannot write: {}{}", path.string(), std::generic_category().message(error),
                                 kept.empty() ? "" : fmt::format("; the content is kept in {}", kept.string())));
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// An open file, closed at the end. Below, an error is the system's number, and 0 is none.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    [[nodiscard]] int number() const { return number_; }
    [[nodiscard]] bool is_open() const { return number_ >= 0; }
    [[nodiscard]] int close() { return ::close(std::exchange(number_, -1)) == 0 ? 0 : errno; }

  private:
    int number_;
};

int write_all(int descriptor, ByteSpan content) {
    while (!content.empty()) {
        const ssize_t written = ::write(descriptor, content.data(), content.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        content = content.subspan(static_cast<std::size_t>(written));
    }
    return 0;
}

/// Flushes to the disk. Some file systems cannot, which is no reason to fail.
int flush(int descriptor) {
    while (::fsync(descriptor) != 0) {
        if (errno == EINTR) continue;
        return errno == EINVAL || errno == ENOSYS || errno == ENOTSUP || errno == EROFS ? 0 : errno;
    }
    return 0;
}

/// So that a new name outlives a loss of power. A folder that may not be read is left alone.
int flush_folder(const fs::path& folder) {
    const Descriptor open(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    return open.is_open() ? flush(open.number()) : 0;
}

/// A new file that is removed again unless it is renamed or kept. Its name does not contain the target's, which may
/// already be as long as a name can be.
class TemporaryFile {
  public:
    explicit TemporaryFile(const fs::path& folder) : descriptor_(create(folder)), error_(errno) {}
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        if (!name_.empty()) ::unlink(name_.c_str());
    }

    /// Why there is none.
    [[nodiscard]] int error() const { return descriptor_.is_open() ? 0 : error_; }

    int fill(ByteSpan content) {
        const int error = write_all(descriptor_.number(), content);
        return error != 0 ? error : flush(descriptor_.number());
    }
    /// Takes the owner, group and mode of the file that it is to replace. Not every user may give them.
    [[nodiscard]] bool becomes_like(const struct stat& old) {
        struct stat own {};
        if (::fstat(descriptor_.number(), &own) != 0) return false;
        const bool is_same_owner = own.st_uid == old.st_uid && own.st_gid == old.st_gid;
        const bool is_given = is_same_owner || ::fchown(descriptor_.number(), old.st_uid, old.st_gid) == 0;
        const mode_t mode = is_given ? old.st_mode & 0777U : 0600U;
        return ::fchmod(descriptor_.number(), mode) == 0 && is_given;
    }
    int rename_to(const fs::path& file) {
        if (const int error = descriptor_.close(); error != 0) return error;
        if (std::rename(name_.c_str(), file.c_str()) != 0) return errno;
        name_.clear();
        return flush_folder(folder_of(file));
    }
    /// It stays. Returns its name.
    fs::path keep() { return std::exchange(name_, {}); }

  private:
    int create(const fs::path& folder) {
        static std::atomic<unsigned> count{0};
        int descriptor = -1;
        do {
            name_ = folder / fmt::format(".raypool-{}-{}.tmp", ::getpid(), count++);
            descriptor = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        } while (descriptor < 0 && (errno == EEXIST || errno == EINTR));
        if (descriptor < 0) name_.clear();
        return descriptor;
    }

    fs::path name_;
    Descriptor descriptor_;
    int error_;
};

/// Writes over the content of a file that is there. Room for it is reserved first: a full disk leaves the old content.
int write_in_place(const fs::path& file, ByteSpan content) {
    Descriptor open(::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    struct stat old {};
    if (!open.is_open() || ::fstat(open.number(), &old) != 0) return errno;
    const auto size = static_cast<off_t>(content.size());
    if (size > old.st_size && ::fallocate(open.number(), 0, 0, size) != 0 &&
        (errno == ENOSPC || errno == EDQUOT || errno == EFBIG)) {
        const int error = errno;
        return ::ftruncate(open.number(), old.st_size) != 0 ? errno : error;
    }
    if (const int error = write_all(open.number(), content); error != 0) return error;
    if (::ftruncate(open.number(), size) != 0) return errno;
    const int error = flush(open.number());
    return error != 0 ? error : open.close();
}

int write_to_device(const fs::path& path, ByteSpan content) {
    Descriptor open(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (!open.is_open()) return errno;
    const int error = write_all(open.number(), content);
    return error != 0 ? error : open.close();
}

/// What a path means, and how to write to it.
struct Target {
    enum class Kind { File, Device, OpenDescriptor };
    Kind kind = Kind::File;
    fs::path file;                   ///< File: the name to rename to
    std::optional<struct stat> old;  ///< File: what is there
    int descriptor = -1;             ///< OpenDescriptor
};

Target find_target(const fs::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        const int error = errno;
        fs::path file = final_file(path);
        if (error != ENOENT || !file.has_filename()) fail(path, error);
        return {Target::Kind::File, std::move(file), {}, -1};
    }
    if (S_ISDIR(status.st_mode)) fail(path, EISDIR);

    // /dev/stdout may lead to a regular file. To replace that file would lose what else goes to standard output.
    for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
        struct stat open_file {};
        if (::fstat(descriptor, &open_file) == 0 && open_file.st_dev == status.st_dev &&
            open_file.st_ino == status.st_ino) {
            return {Target::Kind::OpenDescriptor, {}, {}, descriptor};
        }
    }

    // Renaming over a file asks for rights on its folder only; a write-protected file is left alone all the same.
    if (::access(path.c_str(), W_OK) != 0) fail(path, errno);
    if (!S_ISREG(status.st_mode)) return {Target::Kind::Device, {}, {}, -1};
    return {Target::Kind::File, final_file(path), status, -1};
}

/// The target as the user wrote it, and where it leads if that tells more.
fs::path name_of(const fs::path& path, const Target& target) {
    return target.old || target.file == path ? path
                                             : fs::path(path.string() + " (a link to " + target.file.string() + ")");
}

void write_file(const fs::path& path, const Target& target, ByteSpan content) {
    TemporaryFile temporary(folder_of(target.file));
    if (temporary.error() != 0) {
        const int error = target.old ? write_in_place(target.file, content) : temporary.error();
        if (error != 0) fail(path, error);
        return;
    }
    // First, so that the new file can be read by no more users than the old one.
    const bool is_alike = !target.old || (temporary.becomes_like(*target.old) && target.old->st_nlink == 1);
    int error = temporary.fill(content);
    if (error != 0) fail(path, error);
    if (is_alike) {
        error = temporary.rename_to(target.file);
        if (error == 0) return;
    }
    if (target.old) error = write_in_place(target.file, content);
    if (error != 0) fail(path, error, temporary.keep());
}

}  // namespace

void write_whole(const fs::path& path, std::span<const std::byte> content) {
    const Target target = find_target(path);
    if (target.kind == Target::Kind::File) return write_file(name_of(path, target), target, content);
    const int error =
        target.kind == Target::Kind::Device ? write_to_device(path, content) : write_all(target.descriptor, content);
    if (error != 0) fail(path, error);
}

void check_writable(const fs::path& path) {
    const Target target = find_target(path);
    if (target.kind != Target::Kind::File || target.old) return;
    if (const int error = TemporaryFile(folder_of(target.file)).error(); error != 0) fail(name_of(path, target), error);
}

fs::path final_file(const fs::path& path) {
    constexpr int kMostLinks = 40;  // as many as the system follows
    std::error_code error;
    if (fs::path found = fs::canonical(path, error); !error) return found;
    fs::path file = path;
    for (int i = 0; i < kMostLinks && fs::is_symlink(file, error); ++i)
        file = file.parent_path() / fs::read_symlink(file, error);  // an absolute one takes the whole place
    return file;
}

}  // namespace raypool
