/// No key of random numbers tells anything of another: not of its neighbours, and not of those that differ in few bits.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/math/random.h"
#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

struct Key {
    PathKey<float> path;
    std::uint32_t step;
    RandomPurpose purpose;
    RandomSeed seed;

    [[nodiscard]] std::array<float, 4> numbers() const { return random_block<float>(path, step, purpose, seed); }
};

// ---------------------------------------------------------------- neighbours, among the keys that a render uses

using Neighbour = void (*)(Key&);

/// Each number of a block against each number of the neighbour's block, for the paths of an image, 10 samples a pixel.
void expect_independent(Neighbour neighbour, Sampler sampler = Sampler::Independent) {
    std::array<std::array<Correlation, 4>, 4> correlation;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
        const Key key{{i / 10, i % 10}, i % 3, RandomPurpose::Scatter, random_seed(i % 7, sampler)};
        Key other = key;
        neighbour(other);
        const std::array<float, 4> a = key.numbers();
        const std::array<float, 4> b = other.numbers();
        for (int k = 0; k < 4; ++k)
            for (int l = 0; l < 4; ++l) correlation[k][l].add(a[k], b[l]);
    }
    constexpr int kTests = 17 * 16;
    for (int k = 0; k < 4; ++k) {
        for (int l = 0; l < 4; ++l) {
            EXPECT_FALSE(is_significant(correlation[k][l].p_value(), kTests)) << k << ' ' << l;
            EXPECT_LT(std::abs(correlation[k][l].value()), std::max(0.006, 6 / std::sqrt(kDraws))) << k << ' ' << l;
        }
    }
}
void next_seed(Key& key) {
    static const std::array<RandomSeed, 8> seeds = [] {
        std::array<RandomSeed, 8> all;
        for (std::uint64_t i = 0; i < all.size(); ++i) all[i] = random_seed(i);
        return all;
    }();
    for (std::size_t i = 0; i + 1 < seeds.size(); ++i) {
        if (key.seed.low != seeds[i].low) continue;
        key.seed = {seeds[i + 1].low, seeds[i + 1].high, key.seed.sampler};
        return;
    }
}
template <std::uint32_t branches>
void later_branch(Key& key) {
    key.step += branches << path_step::kBranchShift;
}

TEST(RandomBlock, TellsNothingOfTheNextPixel) {
    expect_independent([](Key& key) { ++key.path.pixel; });
}
TEST(RandomBlock, TellsNothingOfThePixelBelow) {
    expect_independent([](Key& key) { key.path.pixel += 1000; });
}
TEST(RandomBlock, TellsNothingOfPixelsFarAway) {
    expect_independent([](Key& key) { key.path.pixel += 1U << 29U; });
    expect_independent([](Key& key) { key.path.pixel += 1U << 30U; });
    expect_independent([](Key& key) { key.path.pixel += 1U << 31U; });
}
TEST(RandomBlock, TellsNothingOfTheNextSample) {
    expect_independent([](Key& key) { ++key.path.sample; });
}
TEST(RandomBlock, TellsNothingOfASampleFarAway) {
    expect_independent([](Key& key) { key.path.sample += 1U << 30U; });
}
TEST(RandomBlock, TellsNothingOfTheNextBounce) {
    expect_independent([](Key& key) { ++key.step; });
}
TEST(RandomBlock, TellsNothingOfOtherBranches) {
    expect_independent(later_branch<1>);
    expect_independent(later_branch<64>);
    expect_independent(later_branch<128>);
}
TEST(RandomBlock, TellsNothingOfOtherPurposes) {
    expect_independent([](Key& key) { key.purpose = RandomPurpose::Film; });
    expect_independent([](Key& key) { key.purpose = RandomPurpose::Shutter; });
}
TEST(RandomBlock, TellsNothingOfTheNextSeed) {
    expect_independent(next_seed);
}

// The samples of a pixel are meant to know of each other there; nothing else is.
TEST(SobolSampler, TellsNothingOfTheNextPixel) {
    expect_independent([](Key& key) { ++key.path.pixel; }, Sampler::Sobol);
}
TEST(SobolSampler, TellsNothingOfThePixelBelow) {
    expect_independent([](Key& key) { key.path.pixel += 1000; }, Sampler::Sobol);
}
TEST(SobolSampler, TellsNothingOfTheNextBounce) {
    expect_independent([](Key& key) { ++key.step; }, Sampler::Sobol);
}
TEST(SobolSampler, TellsNothingOfABranchFarAway) {
    expect_independent(later_branch<128>, Sampler::Sobol);
}
TEST(SobolSampler, TellsNothingOfTheNextSeed) {
    expect_independent(next_seed, Sampler::Sobol);
}

// ---------------------------------------------------------------- keys that differ in few bits

using KeyWords = std::array<std::uint32_t, 5>;
constexpr std::array<const char*, 5> kWordNames{"pixel", "sample", "step", "lower half of the seed",
                                                "upper half of the seed"};

std::array<float, 4> numbers_of(const KeyWords& words) {
    const std::uint64_t seed = std::uint64_t{words[4]} << 32U | words[3];
    return random_block<float>({words[0], words[1]}, words[2], RandomPurpose::Scatter, random_seed(seed));
}

/// Every bit alone; every two of the highest eight of a word; each of the highest three with each of another word.
std::vector<KeyWords> differences() {
    std::vector<KeyWords> all;
    const auto add = [&](std::size_t word, int bit, std::size_t other_word, int other_bit) {
        KeyWords difference{};
        difference[word] |= 1U << bit;
        difference[other_word] |= 1U << other_bit;
        all.push_back(difference);
    };
    for (std::size_t word = 0; word < kWordNames.size(); ++word) {
        for (int bit = 0; bit < 32; ++bit) add(word, bit, word, bit);
        for (int bit = 24; bit < 32; ++bit)
            for (int other = 24; other < bit; ++other) add(word, bit, word, other);
        for (std::size_t other_word = 0; other_word < word; ++other_word)
            for (int bit = 29; bit < 32; ++bit)
                for (int other = 29; other < 32; ++other) add(word, bit, other_word, other);
    }
    return all;
}

/// What the numbers of keys that differ in so many bits share: the least p-value of the correlation of any two of their
/// numbers, and of any of the 24 bits of a number to change, which it should in half of the cases.
double least_p_value(const KeyWords& difference, const std::vector<KeyWords>& keys,
                     const std::vector<std::array<float, 4>>& numbers) {
    std::array<std::array<Correlation, 4>, 4> correlation;
    std::array<std::array<std::int64_t, 24>, 4> changes{};
    for (std::size_t i = 0; i < keys.size(); ++i) {
        KeyWords other = keys[i];
        for (std::size_t word = 0; word < other.size(); ++word) other[word] ^= difference[word];
        const std::array<float, 4> b = numbers_of(other);
        for (std::size_t k = 0; k < 4; ++k) {
            for (std::size_t l = 0; l < 4; ++l) correlation[k][l].add(numbers[i][k], b[l]);
            const auto bits = [](float number) { return static_cast<std::uint32_t>(number * 0x1p24F); };
            const std::uint32_t changed = bits(numbers[i][k]) ^ bits(b[k]);
            for (std::size_t bit = 0; bit < 24; ++bit) changes[k][bit] += changed >> bit & 1U;
        }
    }
    double least = 1;
    const double half = 0.5 * static_cast<double>(keys.size());
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t l = 0; l < 4; ++l) least = std::min(least, correlation[k][l].p_value());
        for (const std::int64_t count : changes[k])
            least = std::min(least, p_value_of_z((static_cast<double>(count) - half) / std::sqrt(half / 2)));
    }
    return least;
}

TEST(RandomBlock, TellsNothingOfKeysThatDifferInAnyBitOrInTwoOfTheHighestBits) {
    RandomInputs random(1);
    std::vector<KeyWords> keys(5000);
    std::vector<std::array<float, 4>> numbers;
    for (KeyWords& key : keys) {
        for (std::uint32_t& word : key) word = random.word();
        numbers.push_back(numbers_of(key));
    }
    const std::vector<KeyWords> all = differences();
    const int tests = static_cast<int>(all.size()) * (16 + 4 * 24);
    for (const KeyWords& difference : all) {
        std::string named;
        for (std::size_t word = 0; word < difference.size(); ++word)
            for (int bit = 0; bit < 32; ++bit)
                if ((difference[word] >> bit & 1U) != 0)
                    named += std::string(kWordNames[word]) + ", bit " + std::to_string(bit) + "; ";
        EXPECT_FALSE(is_significant(least_p_value(difference, keys, numbers), tests)) << named;
    }
}

}  // namespace
}  // namespace raypool::test
