#include "cli/progress_bar.h"

#include <gtest/gtest.h>

namespace raypool::cli {
namespace {

constexpr ProgressBar::Unit kPaths{"M paths/s", 1e-6};

TEST(ProgressLine, IsShorterThanTheTerminalWhateverItsWidth) {
    for (const std::int64_t done : {0, 1, 500, 999, 1000})
        for (std::size_t columns = 0; columns < 200; ++columns)
            EXPECT_LT(progress_line(done, 0, 1000, kPaths, 2.5, columns).size(), std::max<std::size_t>(columns, 1));
}

TEST(ProgressLine, ShowsMoreWhereThereIsMoreRoom) {
    EXPECT_EQ(progress_line(5'000'000, 0, 10'000'000, kPaths, 2, 5), "");
    EXPECT_EQ(progress_line(5'000'000, 0, 10'000'000, kPaths, 2, 6), " 50 %");
    EXPECT_EQ(progress_line(5'000'000, 0, 10'000'000, kPaths, 2, 20), " 50 %  0:02 left");
    EXPECT_EQ(progress_line(5'000'000, 0, 10'000'000, kPaths, 2, 40), " 50 %  2.50 M paths/s  0:02 left");
    EXPECT_EQ(progress_line(5'000'000, 0, 10'000'000, kPaths, 2, 200),
              "[===============               ]  50 %  2.50 M paths/s  0:02 left");
    EXPECT_EQ(progress_line(0, 0, 10'000'000, kPaths, 2, 30), "[          ]   0 %  -:-- left");
}

TEST(ProgressLine, StaysWithinItsBarForCountsBeyondTheEnd) {
    EXPECT_EQ(progress_line(12, 0, 10, kPaths, 2, 20), "100 %  0:00 left");
    EXPECT_EQ(progress_line(12, 0, 10, kPaths, 2, 80).find("[==============================] 100 %"), 0U);
}

TEST(ProgressLine, OfWhatIsGoneOnWithTakesTheRateOfThisRunOnly) {
    EXPECT_EQ(progress_line(8'000'000, 6'000'000, 10'000'000, kPaths, 2, 40), " 80 %  1.00 M paths/s  0:02 left");
    EXPECT_EQ(progress_line(6'000'000, 6'000'000, 10'000'000, kPaths, 2, 40), " 60 %  0.00 M paths/s  -:-- left");
    EXPECT_EQ(progress_line(10'000'000, 6'000'000, 10'000'000, kPaths, 2, 40), "100 %  2.00 M paths/s  0:00 left");
}

TEST(ProgressLine, OfWhatHasNoKnownEndShowsWhatIsDone) {
    EXPECT_EQ(progress_line(5'000'000, 1'000'000, 0, kPaths, 2, 80), "5.00 M paths  2.00 M paths/s");
    EXPECT_EQ(progress_line(5'000'000, 1'000'000, 0, kPaths, 2, 20), "5.00 M paths");
    EXPECT_EQ(progress_line(5'000'000, 1'000'000, 0, kPaths, 2, 5), "");
}

}  // namespace
}  // namespace raypool::cli
