/// Output files where rights, mounts and full disks stand in the way: the old file or the new one is there, whole.
#include <grp.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "tests/core/base/output_files.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using namespace output_files;

constexpr uid_t kNobody = 65534;
constexpr uid_t kSomebody = 12345;

/// Makes a process that runs as root one of `user` without rights over others' files. Returns whether it is.
bool become(uid_t user) {
    return ::geteuid() == user || (::setgroups(0, nullptr) == 0 && ::setgid(user) == 0 && ::setuid(user) == 0);
}

struct stat status_of(const fs::path& path) {
    struct stat status {};
    EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
    return status;
}

TEST(OutputFile, KeepsTheModeOwnerAndGroupOfTheOldFile) {
    const ScratchFolder folder;
    for (const mode_t mode : {0600U, 0640U, 0666U, 0755U}) {
        set_file_text(folder / "a.txt", "old");
        ASSERT_EQ(::chmod((folder / "a.txt").c_str(), mode), 0);
        const bool is_given = ::chown((folder / "a.txt").c_str(), kSomebody, kNobody) == 0;  // by root
        write_text(folder / "a.txt", "new");
        const struct stat status = status_of(folder / "a.txt");
        EXPECT_EQ(status.st_mode & 07777U, mode);
        EXPECT_EQ(status.st_uid, is_given ? kSomebody : ::geteuid());
        EXPECT_EQ(status.st_gid, is_given ? kNobody : ::getegid());
        EXPECT_EQ(file_text(folder / "a.txt"), "new");
    }
    EXPECT_EQ(entry_count(folder), 1);
}

/// Where a user may write to a file but not replace it.
TEST(OutputFile, IsWrittenInPlaceWhereTheFolderForbidsToReplaceIt) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can make files of two users";
    const ScratchFolder folder;
    fs::permissions(folder.path(), fs::perms::all);
    fs::create_directory(folder / "sticky");
    fs::create_directory(folder / "closed");
    for (const char* name : {"sticky/a.txt", "closed/a.txt", "a.txt"}) {
        set_file_text(folder / name, "old and longer");
        ASSERT_EQ(::chown((folder / name).c_str(), kSomebody, kSomebody), 0);
        ASSERT_EQ(::chmod((folder / name).c_str(), 0666), 0);
    }
    fs::permissions(folder / "sticky", fs::perms::all | fs::perms::sticky_bit);
    fs::permissions(folder / "closed", fs::perms::owner_all | fs::perms::others_exec);
    const int failures = in_child([&] {
        if (!become(kNobody)) return -1;
        int count = 0;
        for (const char* name : {"sticky/a.txt", "closed/a.txt", "a.txt"}) {
            count += !error_of([&] { check_writable(folder / name); }).empty();
            count += !error_of([&] { write_text(folder / name, "new"); }).empty();
        }
        return count;
    });
    EXPECT_EQ(failures, 0);
    for (const char* name : {"sticky/a.txt", "closed/a.txt", "a.txt"}) {
        EXPECT_EQ(file_text(folder / name), "new");
        EXPECT_EQ(status_of(folder / name).st_uid, kSomebody);
        EXPECT_EQ(status_of(folder / name).st_mode & 0777U, 0666U);
    }
    EXPECT_EQ(entry_count(folder), 3);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "sticky"), fs::directory_iterator()), 1);
}

/// As containers mount single files into each other.
TEST(OutputFile, IsWrittenInPlaceWhereItIsAMountPoint) {
    const ScratchFolder folder;
    set_file_text(folder / "mounted.txt", "old");
    set_file_text(folder / "real.txt", "old and longer");
    constexpr int kMayNotMount = 77;
    const int failures = in_child([&] {
        const fs::path target = folder / "mounted.txt";
        if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
            ::mount((folder / "real.txt").c_str(), target.c_str(), nullptr, MS_BIND, nullptr) != 0)
            return kMayNotMount;
        int count = !error_of([&] { check_writable(target); }).empty();
        count += !error_of([&] { write_text(target, "new"); }).empty();
        return count;
    });
    if (failures == kMayNotMount) GTEST_SKIP() << "may not mount";
    EXPECT_EQ(failures, 0);
    EXPECT_EQ(file_text(folder / "real.txt"), "new");
    EXPECT_EQ(entry_count(folder), 2);
}

TEST(OutputFile, IsKeptBesideAndNamedWhereItCannotTakeItsPlace) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root may mount";
    const ScratchFolder folder;
    set_file_text(folder / "a.txt", "old");
    constexpr int kMayNotMount = 77;
    const int failures = in_child([&] {
        const fs::path target = folder / "a.txt";
        // A small disk, full but for its file's own blocks: the file is a mount point that cannot grow.
        fs::create_directory(folder / "disk");
        if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
            ::mount("tmpfs", (folder / "disk").c_str(), "tmpfs", 0, "size=16k") != 0)
            return kMayNotMount;
        set_file_text(folder / "disk/real.txt", "old");
        if (::mount((folder / "disk/real.txt").c_str(), target.c_str(), nullptr, MS_BIND, nullptr) != 0)
            return kMayNotMount;
        const std::string text(100'000, 'x');
        const std::string error = error_of([&] { write_text(target, text); });
        const std::string before = target.string() + ": cannot write: No space left on device; the content is kept in ";
        if (!error.starts_with(before)) return 1;
        int count = file_text(error.substr(before.size())) != text;
        count += file_text(target) != "old";  // room is reserved before anything is written
        return count;
    });
    if (failures == kMayNotMount) GTEST_SKIP() << "may not mount";
    EXPECT_EQ(failures, 0);
}

TEST(OutputFile, AFullDiskLeavesTheOldFileAndNoTemporary) {
    const ScratchFolder folder;
    set_file_text(folder / "a.txt", "old");
    const int failures = in_child([&] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{4096, 4096};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        const std::string text(8192, 'x');
        const std::string replaced = error_of([&] { write_text(folder / "a.txt", text); });
        const std::string created = error_of([&] { write_text(folder / "b.txt", text); });
        const std::string expected = ": cannot write: File too large";
        return (replaced == (folder / "a.txt").string() + expected ? 0 : 1) +
               (created == (folder / "b.txt").string() + expected ? 0 : 2);
    });
    EXPECT_EQ(failures, 0);
    EXPECT_EQ(file_text(folder / "a.txt"), "old");
    EXPECT_EQ(entry_count(folder), 1);
}

TEST(OutputFile, AFullDeviceIsReportedByName) {
    EXPECT_EQ(error_of([] { write_text("/dev/full", "a"); }), "/dev/full: cannot write: No space left on device");
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(OutputFile, RespectsWriteProtection) {
    const ScratchFolder folder;
    fs::create_directory(folder / "locked");
    set_file_text(folder / "protected.txt", "old");
    fs::permissions(folder / "protected.txt", fs::perms::owner_read);
    fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    fs::permissions(folder.path(), fs::perms::all);
    const int failures = in_child([&] {
        if (::geteuid() == 0 && ::setuid(65534) != 0) return 0;  // root may write everywhere
        int count = 0;
        for (const char* name : {"protected.txt", "locked/a.txt"}) {
            const std::string expected = (folder / name).string() + ": cannot write: Permission denied";
            count += error_of([&] { check_writable(folder / name); }) != expected;
            count += error_of([&] { write_text(folder / name, "new"); }) != expected;
        }
        return count;
    });
    fs::permissions(folder / "locked", fs::perms::owner_all);
    EXPECT_EQ(failures, 0);
}

}  // namespace
}  // namespace raypool
