/// One process at a time works on a file, whatever happens to the file and to the process.
#include "core/base/file_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "core/base/error.h"
#include "core/base/output_file.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

bool is_free(const fs::path& path) {
    try {
        const FileLock lock(path);
        return true;
    } catch (const InputError& error) {
        EXPECT_EQ(error.what(), path.string() + ": another raypool is at work on it");
        return false;
    }
}

TEST(FileLock, KeepsOthersOutWhileTheFileComesAndIsReplaced) {
    const ScratchFolder folder;
    const fs::path path = folder / "a.sums";
    {
        const FileLock lock(path);
        EXPECT_FALSE(is_free(path));
        for (const std::string text : {"one", "two"}) {
            write_whole(path, std::as_bytes(std::span(text)));
            EXPECT_FALSE(is_free(path));
        }
        EXPECT_TRUE(is_free(folder / "b.sums"));
    }
    EXPECT_TRUE(is_free(path));
    EXPECT_EQ(entry_count(folder), 1);  // and leaves nothing behind
}

TEST(FileLock, IsOneForAllLinksToAFile) {
    const ScratchFolder folder;
    fs::create_directory(folder / "scratch");
    fs::create_symlink("scratch/a.sums", folder / "link.sums");
    const FileLock lock(folder / "link.sums");
    EXPECT_FALSE(is_free(folder / "scratch/a.sums"));
    EXPECT_FALSE(is_free(folder / "link.sums"));
}

TEST(FileLock, EndsWithAProcessThatIsKilled) {
    const ScratchFolder folder;
    const fs::path path = folder / "a.sums";
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        const FileLock lock(path);
        static_cast<void>(!::write(ready[1], "x", 1));
        for (;;) ::pause();
    }
    char byte = 0;
    EXPECT_EQ(::read(ready[0], &byte, 1), 1);
    EXPECT_FALSE(is_free(path));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    EXPECT_TRUE(is_free(path));
    EXPECT_EQ(entry_count(folder), 0);
    ::close(ready[0]);
    ::close(ready[1]);
}

TEST(FileLock, IsOfTheFileItselfWhereItsFolderIsClosed) {
    const ScratchFolder folder;
    fs::create_directory(folder / "closed");
    set_file_text(folder / "closed/a.sums", "old");
    fs::permissions(folder / "closed/a.sums", fs::perms(0666));
    fs::permissions(folder / "closed", fs::perms(0555));
    fs::permissions(folder.path(), fs::perms::all);
    const pid_t child = ::fork();
    if (child == 0) {
        if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(1);
        const FileLock lock(folder / "closed/a.sums");
        ::_exit(is_free(folder / "closed/a.sums") ? 1 : 0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    fs::permissions(folder / "closed", fs::perms::owner_all);
}

TEST(FileLock, IsNoneOfADevice) {
    const FileLock lock("/dev/null");
    EXPECT_TRUE(is_free("/dev/null"));
}

}  // namespace
}  // namespace raypool
