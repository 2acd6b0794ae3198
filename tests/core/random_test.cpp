/// The keyed random numbers: their definition, their range, and that no key tells anything about its neighbour.
#include "core/random.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

/// pcg4d as published, on all four words.
std::array<std::uint32_t, 4> pcg4d(std::array<std::uint32_t, 4> v) {
    const auto mix = [&] {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
    };
    for (std::uint32_t& word : v) word = word * 1664525U + 1013904223U;
    mix();
    for (std::uint32_t& word : v) word ^= word >> 16U;
    mix();
    return v;
}

TEST(RandomBlock, IsPcg4dOfItsKey) {
    RandomInputs random(1);
    for (int i = 0; i < kInputs / 10; ++i) {
        const std::uint32_t pixel = random.word(), sample = random.word(), block = random.word();
        const RandomSeed seed{random.word(), random.word()};
        const std::array<std::uint32_t, 4> words = pcg4d({pixel + seed.low, sample, block, seed.high});
        const std::array<float, 4> in_float = random_block<float>(pixel, sample, block, seed);
        const std::array<double, 4> in_double = random_block<double>(pixel, sample, block, seed);
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
        const std::array<float, 4> block = random_block<float>(i / 40, i % 10, i / 10 % 4, seed);
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

/// The key of the i-th path of an image 1000 wide, 10 samples a pixel.
struct Key {
    std::uint32_t pixel, sample, block;
    std::uint64_t seed;
};
using Neighbour = void (*)(Key&);

/// Each number of a block against each number of the neighbour's block.
void expect_independent(Neighbour neighbour, Sampler sampler = Sampler::Independent) {
    std::array<std::array<Correlation, 4>, 4> correlation;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
        const Key key{i / 10, i % 10, 2 + i % 3, i % 7};
        Key other = key;
        neighbour(other);
        const auto a = random_block<float>(key.pixel, key.sample, key.block, random_seed(key.seed, sampler));
        const auto b = random_block<float>(other.pixel, other.sample, other.block, random_seed(other.seed, sampler));
        for (int k = 0; k < 4; ++k)
            for (int l = 0; l < 4; ++l) correlation[k][l].add(a[k], b[l]);
    }
    constexpr int kTests = 9 * 16;
    for (int k = 0; k < 4; ++k) {
        for (int l = 0; l < 4; ++l) {
            EXPECT_FALSE(is_significant(correlation[k][l].p_value(), kTests)) << k << ' ' << l;
            EXPECT_LT(std::abs(correlation[k][l].value()), std::max(0.006, 6 / std::sqrt(kDraws))) << k << ' ' << l;
        }
    }
}

TEST(RandomBlock, TellsNothingOfTheNextPixel) {
    expect_independent([](Key& key) { ++key.pixel; });
}
TEST(RandomBlock, TellsNothingOfThePixelBelow) {
    expect_independent([](Key& key) { key.pixel += 1000; });
}
TEST(RandomBlock, TellsNothingOfTheNextSample) {
    expect_independent([](Key& key) { ++key.sample; });
}
TEST(RandomBlock, TellsNothingOfTheNextBounce) {
    expect_independent([](Key& key) { ++key.block; });
}
TEST(RandomBlock, TellsNothingOfTheNextSeed) {
    expect_independent([](Key& key) { ++key.seed; });
}

// The samples of a pixel are meant to know of each other there; nothing else is.
TEST(SobolSampler, TellsNothingOfTheNextPixel) {
    expect_independent([](Key& key) { ++key.pixel; }, Sampler::Sobol);
}
TEST(SobolSampler, TellsNothingOfThePixelBelow) {
    expect_independent([](Key& key) { key.pixel += 1000; }, Sampler::Sobol);
}
TEST(SobolSampler, TellsNothingOfTheNextBounce) {
    expect_independent([](Key& key) { ++key.block; }, Sampler::Sobol);
}
TEST(SobolSampler, TellsNothingOfTheNextSeed) {
    expect_independent([](Key& key) { ++key.seed; }, Sampler::Sobol);
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
