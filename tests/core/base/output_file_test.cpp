/// Output files as links, pipes and readers see them: whole, under the names that they had.
#include "core/base/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/base/output_files.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using namespace output_files;

TEST(OutputFile, HoldsExactlyWhatWasWritten) {
    const ScratchFolder folder;
    const std::string text(100'000, 'x');
    write_text(folder / "new.txt", text);
    EXPECT_EQ(file_text(folder / "new.txt"), text);
    write_text(folder / "new.txt", "short");
    EXPECT_EQ(file_text(folder / "new.txt"), "short");
    write_text(folder / "empty.txt", "");
    EXPECT_EQ(fs::file_size(folder / "empty.txt"), 0U);
    EXPECT_EQ(entry_count(folder), 2);
}

TEST(OutputFile, FollowsTheUmaskLikeAnyOtherFile) {
    const ScratchFolder folder;
    const int is_wrong = in_child([&] {
        ::umask(0027);
        write_text(folder / "a.txt", "a");
        struct stat status {};
        ::stat((folder / "a.txt").c_str(), &status);
        return (status.st_mode & 0777) == 0640 ? 0 : 1;
    });
    EXPECT_EQ(is_wrong, 0);
}

TEST(OutputFile, TakesNamesAsLongAsTheSystemDoes) {
    const ScratchFolder folder;
    const std::string name(255, 'n');
    EXPECT_EQ(error_of([&] { write_text(folder / name, "a"); }), "");
    EXPECT_NE(error_of([&] { check_writable(folder / (name + "n")); }), "");
}

TEST(OutputFile, LeavesALinkALink) {
    const ScratchFolder folder;
    set_file_text(folder / "real.txt", "old");
    fs::create_symlink("real.txt", folder / "link.txt");
    write_text(folder / "link.txt", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
    EXPECT_EQ(file_text(folder / "real.txt"), "new");
}

TEST(OutputFile, FollowsALinkThatLeadsToNoFileYet) {
    const ScratchFolder folder;
    fs::create_directory(folder / "scratch");
    fs::create_symlink("scratch/real.txt", folder / "near.txt");
    fs::create_symlink(folder / "near.txt", folder / "far.txt");
    check_writable(folder / "far.txt");
    write_text(folder / "far.txt", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "far.txt"));
    EXPECT_TRUE(fs::is_symlink(folder / "near.txt"));
    EXPECT_EQ(file_text(folder / "scratch/real.txt"), "new");

    fs::create_symlink("absent/real.txt", folder / "lost.txt");
    for (const auto& action : {check_writable, +[](const fs::path& path) { write_text(path, "new"); }}) {
        const std::string error = error_of([&] { action(folder / "lost.txt"); });
        EXPECT_NE(error.find("lost.txt (a link to "), std::string::npos) << error;
    }
    fs::create_symlink("loop.txt", folder / "loop.txt");
    EXPECT_NE(error_of([&] { write_text(folder / "loop.txt", "new"); }), "");
    EXPECT_EQ(entry_count(folder), 5);
}

TEST(OutputFile, KeepsAllNamesOfAFile) {
    const ScratchFolder folder;
    set_file_text(folder / "a.txt", "old and longer");
    fs::create_hard_link(folder / "a.txt", folder / "b.txt");
    write_text(folder / "a.txt", "new");
    EXPECT_EQ(file_text(folder / "b.txt"), "new");
    EXPECT_EQ(fs::hard_link_count(folder / "a.txt"), 2U);
    EXPECT_EQ(entry_count(folder), 2);
}

TEST(OutputFile, WritesIntoDevicesAndPipesWithoutReplacingThem) {
    write_text("/dev/null", "a");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));

    const ScratchFolder folder;
    const fs::path pipe = folder / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = file_text(pipe); });
    write_text(pipe, "through the pipe");
    reader.join();
    EXPECT_EQ(received, "through the pipe");
    EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(OutputFile, StandardOutputLeadingToAFileKeepsWhatElseGoesThere) {
    const ScratchFolder folder;
    const int failures = in_child([&] {
        const int file = ::open((folder / "out.txt").c_str(), O_WRONLY | O_CREAT, 0600);
        ::dup2(file, STDOUT_FILENO);
        bool is_complete = ::write(STDOUT_FILENO, "before ", 7) == 7;
        write_text("/dev/stdout", "content");
        is_complete &= ::write(STDOUT_FILENO, " after", 6) == 6;
        return is_complete ? 0 : 1;
    });
    EXPECT_EQ(failures, 0);
    EXPECT_EQ(file_text(folder / "out.txt"), "before content after");
}

TEST(OutputFile, RefusesFoldersAndPlacesInFoldersThatAreNotThere) {
    const ScratchFolder folder;
    const std::string here = folder.path().string();
    set_file_text(folder / "file", "old");
    struct Case {
        std::string path, expected;
    };
    const std::vector<Case> cases{
        {here, here + ": cannot write: Is a directory"},
        {here + "/", here + "/: cannot write: Is a directory"},
        {here + "/absent/a.txt", here + "/absent/a.txt: cannot write: No such file or directory"},
        {here + "/absent/", here + "/absent/: cannot write: No such file or directory"},
        {here + "/file/a.txt", here + "/file/a.txt: cannot write: Not a directory"},
        {"", ": cannot write: No such file or directory"},
    };
    for (const Case& refused : cases) {
        EXPECT_EQ(error_of([&] { check_writable(refused.path); }), refused.expected);
        EXPECT_EQ(error_of([&] { write_text(refused.path, "new"); }), refused.expected);
    }
    EXPECT_EQ(entry_count(folder), 1);
    EXPECT_EQ(file_text(folder / "file"), "old");
}

TEST(OutputFile, CheckingAheadChangesNothing) {
    const ScratchFolder folder;
    set_file_text(folder / "old.txt", "old");
    const auto modified = fs::last_write_time(folder / "old.txt");
    check_writable(folder / "old.txt");
    check_writable(folder / "new.txt");
    check_writable("/dev/null");
    EXPECT_EQ(file_text(folder / "old.txt"), "old");
    EXPECT_EQ(fs::last_write_time(folder / "old.txt"), modified);
    EXPECT_EQ(entry_count(folder), 1);
}

TEST(OutputFile, ReadersSeeTheOldContentOrTheNewNeverAPart) {
    const ScratchFolder folder;
    const fs::path path = folder / "a.txt";
    const std::string first(300'000, 'a');
    const std::string second(200'000, 'b');
    write_text(path, first);
    std::thread writer([&] {
        for (int i = 0; i < 50; ++i) write_text(path, i % 2 == 0 ? second : first);
    });
    int partial_count = 0;
    for (int i = 0; i < 100; ++i) {
        const std::string seen = file_text(path);
        partial_count += seen != first && seen != second;
    }
    writer.join();
    EXPECT_EQ(partial_count, 0);
}

}  // namespace
}  // namespace raypool
