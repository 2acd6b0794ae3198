// What nvcc makes of the operations, translated and run, does what the host does, bit by bit.

#include <gtest/gtest.h>

#include <vector>

#include "tests/gpu/operations_check.h"
#include "tests/gpu/ptx/machine.h"

namespace raypool::gpu {
namespace {

TEST(PtxOperations, AreThoseOfTheHost) {
    constexpr std::uint32_t kCount = 1 << 18;
    constexpr std::uint32_t kThreads = 128;
    std::vector<std::uint32_t> out(std::size_t{kCount} * kOperations);
    std::uint32_t first = 0;
    std::uint32_t count = kCount;
    std::uint32_t* data = out.data();
    void* parameters[] = {&first, &count, &data};
    ptx::run_grid(ptx::find_kernel("run_operations"), parameters, kCount / kThreads, kThreads);
    // The machine rounds as IEEE 754 does and flushes what is then denormal, which x86 does not.
    const int apart = check_operations(0, out);
    EXPECT_GT(apart, 0);
    RecordProperty("rounded_to_least_normal", apart);
}

}  // namespace
}  // namespace raypool::gpu
