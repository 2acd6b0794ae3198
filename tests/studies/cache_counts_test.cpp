// Counts of cache misses: cachegrind's file as it writes it, and counters that may or may not exist.

#include "bench/studies/cache_counts.h"

#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bench/studies/record_traffic.h"

namespace raypool::studies {
namespace {

// Lines of a function may come in several pieces, and zeros at the end of a line are left out.
constexpr const char* kFile =
    "desc: I1 cache:         32768 B, 64 B, 8-way associative\n"
    "desc: D1 cache:         32768 B, 64 B, 8-way associative\n"
    "cmd: raypool render paper --spp=2\n"
    "events: Ir I1mr ILmr Dr D1mr DLmr Dw D1mw DLmw\n"
    "fl=???\n"
    "fn=void raypool::wavefront::advance<float>(int) [clone ._omp_fn.0]\n"
    "0 1000 1 1 400 40 4 200 20 2\n"
    "12 10 0 0 5\n"
    "fn=main\n"
    "0 7 7 7 7 7 7 7 7 7\n"
    "fl=/src/wavefront/append.h\n"
    "fn=void raypool::wavefront::advance<float>(int) [clone ._omp_fn.0]\n"
    "3 1 0 0 1 1 1 1 1 1\n"
    "summary: 1018 8 8 413 48 12 208 28 10\n";

TEST(CachegrindFile, AddsUpTheFunctionsThatAreWanted) {
    std::istringstream file(kFile);
    const CacheCounts counts =
        read_cachegrind(file, [](const std::string& name) { return name.find("wavefront") != std::string::npos; });
    EXPECT_EQ(counts.reads, 406);
    EXPECT_EQ(counts.d1_read_misses, 41);
    EXPECT_EQ(counts.ll_read_misses, 5);
    EXPECT_EQ(counts.writes, 201);
    EXPECT_EQ(counts.d1_write_misses, 21);
    EXPECT_EQ(counts.ll_write_misses, 3);
}

TEST(CachegrindFile, OfAllFunctionsAddsUpToItsSummary) {
    std::istringstream file(kFile);
    const CacheCounts counts = read_cachegrind(file, [](const std::string&) { return true; });
    EXPECT_EQ(counts.reads, 413);
    EXPECT_EQ(counts.writes, 208);
    EXPECT_EQ(counts.d1_write_misses, 28);
}

TEST(CachegrindFile, IsRefusedWhereItCountedNoCaches) {
    std::istringstream file("events: Ir\nfn=main\n0 7\n");
    EXPECT_THROW(read_cachegrind(file, [](const std::string&) { return true; }), std::runtime_error);
    std::istringstream nothing("");
    EXPECT_THROW(read_cachegrind(nothing, [](const std::string&) { return true; }), std::runtime_error);
}

TEST(Cachegrind, HasACommandOrAReason) {
    const CachegrindCommand& command = cachegrind_command();
    EXPECT_NE(command.path.empty(), command.why.empty());
}

TEST(HardwareCounters, CountWhatIsReadOrSayThatTheyAreNotThere) {
    bool is_called = false;
    const auto counts = count_by_hardware([&] {
        is_called = true;
        volatile int memory[4096] = {};
        for (int i = 0; i < 4096; ++i) (void)memory[i];
    });
    EXPECT_EQ(counts.has_value(), is_called);
    if (counts && counts->reads) {
        EXPECT_GE(*counts->reads, 4096);
    }
}

TEST(RecordPass, CostsSomethingForEachRecordOfAnySizeOfPool) {
    for (const auto width : {wavefront::StageWidth::Scalar, wavefront::StageWidth::Simd})
        for (const std::int64_t capacity : {1, 17, 4096})
            for (const double survivors : {0.0, 0.6, 1.0}) EXPECT_GT(record_pass_s({}, width, capacity, survivors), 0);
}

}  // namespace
}  // namespace raypool::studies
