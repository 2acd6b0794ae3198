/// Random numbers as programs often make them. The engines' are random_block() (core/math/random.h).
#pragma once

#include <cstdint>

#include "core/math/real.h"

namespace raypool::naive {

/// A word over 2^32: the float nearest to a number just below 1 is 1.
inline float word_to_unit(std::uint32_t word) {
    return static_cast<float>(word) * 0x1p-32F;
}
/// What random_block() does with a word.
inline float high_bits_to_unit(std::uint32_t word) {
    return from_uint32<float>(word >> 8U) * 0x1p-24F;
}

/// std::minstd_rand's step: the first number is the seed times a constant.
inline float minstd_first(std::uint32_t seed) {
    const std::uint64_t state = std::uint64_t{seed % 2147483647U} * 48271U % 2147483647U;
    return static_cast<float>(static_cast<double>(state) / 2147483647.0);
}
/// Marsaglia's xorshift, which is linear: seeds that differ in few bits give numbers that do.
inline float xorshift_first(std::uint32_t seed) {
    std::uint32_t x = seed;
    x ^= x << 13U, x ^= x >> 17U, x ^= x << 5U;
    return high_bits_to_unit(x);
}

/// A generator of one thread, as `rand()` with a state of its own.
class ThreadGenerator {
  public:
    explicit ThreadGenerator(std::uint64_t thread_id) : state_(thread_id) {}
    float next() {
        state_ = state_ * 6364136223846793005U + 1442695040888963407U;
        return high_bits_to_unit(static_cast<std::uint32_t>(state_ >> 32U));
    }

  private:
    std::uint64_t state_;
};

}  // namespace raypool::naive
