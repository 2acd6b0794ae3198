/// The keyed random numbers: their definition, their range, and that no key tells anything about its neighbour.
#include "core/math/random.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

/// pcg4d but for what core/math/random.h tells.
std::array<std::uint32_t, 4> hash_of(std::array<std::uint32_t, 4> v) {
    const auto mix = [&] {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
    };
    for (const int i : {0, 1, 2}) {
        v[i] = v[i] * 1664525U + (i == 0 ? 0 : 1013904223U);
        v[i] ^= v[i] >> 15U;
    }
    mix();
    for (const int i : {0, 1, 3}) v[i] ^= v[i] >> 16U;
    mix();
    return v;
}

constexpr std::array kPurposes{RandomPurpose::Film, RandomPurpose::Shutter, RandomPurpose::Scatter};

TEST(RandomBlock, IsTheHashOfItsKey) {
    RandomInputs random(1);
    for (int i = 0; i < kInputs / 10; ++i) {
        const std::uint32_t pixel = random.word(), sample = random.word(), step = random.word();
        const RandomPurpose purpose = kPurposes[static_cast<std::size_t>(random.below(3))];
        const RandomSeed seed{random.word(), random.word()};
        const std::array<std::uint32_t, 4> words =
            hash_of({pixel + seed.low, sample, step, seed.high + static_cast<std::uint32_t>(purpose) * 0x9e3779b9U});
        const std::array<float, 4> in_float = random_block<float>({pixel, sample}, step, purpose, seed);
        const std::array<double, 4> in_double = random_block<double>({pixel, sample}, step, purpose, seed);
        for (int k = 0; k < 4; ++k) {
            ASSERT_EQ(in_float[k], static_cast<float>(words[k] >> 8U) / 16777216);
            ASSERT_EQ(in_double[k], in_float[k]);  // both precisions follow the same paths
        }
    }
}

TEST(RandomBlock, IsBelowOneForEveryWord) {
    EXPECT_LT(from_uint32<float>(0xffffffffU >> 8U) * 0x1p-24F, 1);
    EXPECT_EQ(static_cast<float>(0xffffffffU) * 0x1p-32F, 1) << "what all 32 bits would give";
}

constexpr int kUniformityTests = 4 + 4 + 6;

TEST(RandomBlock, IsUniformInEachNumberItsLowBitsAndEachPair) {
    std::array<std::vector<std::int64_t>, 4> high;
    std::array<std::vector<std::int64_t>, 4> low;
    std::array<std::array<std::vector<std::int64_t>, 4>, 4> pair;
    for (int a = 0; a < 4; ++a) {
        high[a].resize(256), low[a].resize(256);
        for (auto& counts : pair[a]) counts.resize(32 * 32);
    }
    // As a render draws them: line by line, some samples, some bounces.
    const RandomSeed seed = random_seed(0);
    for (std::uint32_t i = 0; i < kDraws; ++i) {
        const std::array<float, 4> block =
            random_block<float>({i / 40, i % 10}, i / 10 % 4, RandomPurpose::Scatter, seed);
        std::array<std::uint32_t, 4> word;
        for (int a = 0; a < 4; ++a) {
            word[a] = static_cast<std::uint32_t>(block[a] * 0x1p24F);
            ++high[a][word[a] >> 16U];
            ++low[a][word[a] & 255U];
        }
        for (int a = 0; a < 4; ++a)
            for (int b = 0; b < a; ++b) ++pair[a][b][(word[a] >> 19U) * 32 + (word[b] >> 19U)];
    }
    for (int a = 0; a < 4; ++a) {
        EXPECT_FALSE(is_significant(p_value_of_uniform_counts(high[a]), kUniformityTests)) << a;
        EXPECT_FALSE(is_significant(p_value_of_uniform_counts(low[a]), kUniformityTests)) << a;
        for (int b = 0; b < a; ++b)
            EXPECT_FALSE(is_significant(p_value_of_uniform_counts(pair[a][b]), kUniformityTests)) << a << ' ' << b;
    }
}

TEST(RandomSeed, IsTheFirstNumberOfSplitmix64) {
    EXPECT_EQ(random_seed(0).high, 0xe220a839U);
    EXPECT_EQ(random_seed(0).low, 0x7b1dcdafU);
}

TEST(RandomSeed, DiffersInBothWordsForNeighbours) {
    std::set<std::uint32_t> low;
    std::set<std::uint32_t> high;
    constexpr std::uint64_t kSeeds = 1000;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        low.insert(random_seed(seed).low);
        high.insert(random_seed(seed).high);
    }
    EXPECT_EQ(low.size(), kSeeds);
    EXPECT_EQ(high.size(), kSeeds);
}

}  // namespace
}  // namespace raypool::test
