// Memory counts where it is used, also where it is given back before the end.
#include "bench/studies/peak_memory.h"

#include <vector>

#include <gtest/gtest.h>

namespace raypool::studies {
namespace {

constexpr std::size_t kMegabyte = 1 << 20;

TEST(PeakGrowth, IsWhatWorkHasAtOnceAtMost) {
    const std::vector<char> of_others(64 * kMegabyte, 1);
    const auto growth = peak_growth([] {
        { const std::vector<char> first(32 * kMegabyte, 1); }
        const std::vector<char> second(16 * kMegabyte, 1);
    });
    if (!growth) GTEST_SKIP() << "the system does not say";
    EXPECT_GE(*growth, 31 * kMegabyte);
#ifndef RAYPOOL_SANITIZED  // which have memory of their own, and keep what is given back
    EXPECT_LE(*growth, 40 * kMegabyte);
#endif
}

TEST(PeakGrowth, CallsTheWorkOnce) {
    int calls = 0;
    peak_growth([&] { ++calls; });
    EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace raypool::studies
