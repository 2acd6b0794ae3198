/// What ranks say to each other before work begins, and which of them ends it.
#include "cluster/agreement.h"

#include <gtest/gtest.h>

namespace raypool::cluster {
namespace {

const Statement kReady{0, "", {{"width", "100"}, {"seed", "0"}}};
const Statement kOtherSeed{0, "", {{"width", "100"}, {"seed", "5"}}};
const Statement kFailed{1, "out of memory", {}};

TEST(Agreement, HearsWhatIsSaid) {
    for (const Statement& statement : {kReady, kFailed, Statement{2, "sc\xff\tne: no file", {}}, Statement{}})
        EXPECT_EQ(decoded(encoded(statement)), statement) << statement.error;
    const Statement empty_value{0, "", {{"scene", ""}, {"seed", "0"}}};
    EXPECT_EQ(decoded(encoded(empty_value)), empty_value);
}

TEST(Agreement, IsReachedByRanksThatSayTheSame) {
    EXPECT_FALSE(refusal(std::vector{kReady}));
    EXPECT_FALSE(refusal(std::vector{kReady, kReady, kReady}));
}

TEST(Agreement, NamesTheFirstRankThatDiffersAndInWhat) {
    EXPECT_EQ(refusal(std::vector{kReady, kReady, kOtherSeed, kOtherSeed}),
              (Statement{2, "rank 2 of 4 differs from rank 0: seed 5, not 0", {}}));
    const Statement help{0, "", {{"command", "help"}}};
    EXPECT_EQ(refusal(std::vector{kReady, help}), (Statement{2, "rank 1 of 2 differs from rank 0: no width", {}}));
    EXPECT_TRUE(refusal(std::vector{help, kReady}));
}

TEST(Agreement, NamesARankThatFailedBeforeOnesThatDiffer) {
    EXPECT_EQ(refusal(std::vector{kReady, kOtherSeed, kFailed, kFailed}),
              (Statement{1, "rank 2 of 4: out of memory", {}}));
}

TEST(Agreement, IsNotAskedForWhereThereIsOneRank) {
    Ranks alone;
    agree(alone, kReady.terms);
    EXPECT_FALSE(alone.has_agreed());
}

}  // namespace
}  // namespace raypool::cluster
