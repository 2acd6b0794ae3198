/// What memory can be had: by the limits of control groups, each and all of their parents.
#include "core/base/memory.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

void limit(const std::filesystem::path& group, const std::string& most, const std::string& used,
           const std::string& stat = "") {
    std::filesystem::create_directories(group);
    set_file_text(group / "memory.max", most + "\n");
    set_file_text(group / "memory.current", used + "\n");
    if (!stat.empty()) set_file_text(group / "memory.stat", stat);
}

std::size_t memory_of(const ScratchFolder& root, const std::string& group) {
    return control_group_memory(root.path().string(), group, "memory.max", "memory.current");
}

TEST(ControlGroupMemory, IsTheLeastThatAGroupAndItsParentsLeave) {
    const ScratchFolder root;
    EXPECT_EQ(memory_of(root, "/"), kNoLimit);
    EXPECT_EQ(memory_of(root, "/job/step"), kNoLimit);
    limit(root / "job", "1000", "300");
    limit(root / "job/step", "900", "100");
    EXPECT_EQ(memory_of(root, "/job/step"), 700U);
    EXPECT_EQ(memory_of(root, "/job"), 700U);
    EXPECT_EQ(memory_of(root, "/other"), kNoLimit);
    limit(root / "job/step", "max", "100");
    EXPECT_EQ(memory_of(root, "/job/step"), 700U);
    limit(root.path(), "50", "60");  // in use beyond a limit that was lowered
    EXPECT_EQ(memory_of(root, "/job/step"), 0U);
}

TEST(ControlGroupMemory, CountsFilesInTheCacheAsToBeHad) {
    const ScratchFolder root;
    limit(root / "job", "1000", "900", "anon 100\ninactive_file 600\nactive_file 200\n");
    EXPECT_EQ(memory_of(root, "/job"), 700U);
}

TEST(Memory, OfThisMachineIsKnownAndMoreThanItIsRefusedWithBothFigures) {
    const std::size_t available = available_memory();
    EXPECT_GT(available, 0U);
    EXPECT_LT(available, kNoLimit);
    EXPECT_NO_THROW(check_available(1, "a byte"));
    try {
        check_available(std::size_t{1} << 60U, "the pools");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find("the pools take 1152921504.6 GB, of "), 0U) << error.what();
    }
}

}  // namespace
}  // namespace raypool
