/// Points of Sobol's sequence in four dimensions, in a shuffled order and Owen-scrambled, by hashing.
///
/// After Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020: no tables but the direction numbers, no
/// state, and any point at any time. The first 2^k points of a shuffled order are again 2^k points of the sequence that
/// lie as evenly as the first. Called by core/math/random.h, with one word or a register of words.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/real.h"

namespace raypool::sobol {

inline constexpr int kDimensions = 4;

/// The direction numbers of a dimension, bits reversed: the lowest bit of number i is the first binary digit of what
/// bit i of the index adds to the point. Of the tables of Joe and Kuo (new-joe-kuo-6.21201, 2008), which gives for each
/// dimension a primitive polynomial (its degree, its inner coefficients) and odd numbers to begin with.
struct Directions {
    std::array<std::uint32_t, 32> reversed;
};
constexpr Directions directions(int degree, std::uint32_t coefficients, std::array<std::uint32_t, 3> first) {
    std::array<std::uint32_t, 32> m{};  // m[i] is odd and below 2^(i + 1): the digits of direction number i as a whole
    for (int i = 0; i < 32; ++i) {
        if (i < degree) {
            m[i] = first[i];
            continue;
        }
        m[i] = m[i - degree] ^ m[i - degree] << degree;
        for (int k = 1; k < degree; ++k)
            if ((coefficients >> (degree - 1 - k) & 1U) != 0) m[i] ^= m[i - k] << k;
    }
    Directions out{};
    for (int i = 0; i < 32; ++i)
        for (int digit = 0; digit <= i; ++digit) out.reversed[i] |= (m[i] >> (i - digit) & 1U) << digit;
    return out;
}
/// Dimensions 1 to 3. Those of dimension 0 are 1, 2, 4, ...: reversed, a point is its index.
RAYPOOL_CONSTANT std::array<Directions, kDimensions - 1> kDirections{directions(1, 0, {1}), directions(2, 1, {1, 3}),
                                                                     directions(3, 1, {1, 3, 1})};

template <class U>
RAYPOOL_INLINE U reversed_bits(U x) {
    x = (x >> 1 & U(0x55555555U)) | (x & U(0x55555555U)) << 1;
    x = (x >> 2 & U(0x33333333U)) | (x & U(0x33333333U)) << 2;
    x = (x >> 4 & U(0x0f0f0f0fU)) | (x & U(0x0f0f0f0fU)) << 4;
    x = (x >> 8 & U(0x00ff00ffU)) | (x & U(0x00ff00ffU)) << 8;
    return x >> 16 | x << 16;
}

/// A random permutation of 32-bit words in which a bit depends on itself and lower ones only: Owen's nested uniform
/// scrambling of digits that are written lowest first. The hash is Laine and Karras's with the constants of Vegdahl,
/// "Building a Better LK Hash" (2021), which leave less structure.
template <class U>
RAYPOOL_INLINE U scrambled_reversed(U x, const U& key) {
    x ^= x * U(0x3d20adeaU);
    x += key;
    x *= key >> 16 | U(1U);
    x ^= x * U(0x05526c56U);
    x ^= x * U(0x53a22864U);
    return x;
}

/// Point `number` of the sequence that the keys pick: `order` shuffles it, scramble[i] scrambles dimension i. Fractions
/// of 2^32.
template <class U>
RAYPOOL_INLINE std::array<U, kDimensions> scrambled_point(const U& number, const U& order,
                                                          const std::array<U, kDimensions>& scramble) {
    const U index = reversed_bits<U>(scrambled_reversed<U>(reversed_bits<U>(number), order));
    std::array<U, kDimensions> point;
    point[0] = index;
    for (int i = 1; i < kDimensions; ++i) {
        point[i] = U(0U);
        for (int bit = 0; bit < 32; ++bit) {
            const U is_set = index >> bit & U(1U);
            point[i] ^= (U(0U) - is_set) & U(kDirections[i - 1].reversed[bit]);
        }
    }
    for (int i = 0; i < kDimensions; ++i) point[i] = reversed_bits<U>(scrambled_reversed<U>(point[i], scramble[i]));
    return point;
}

}  // namespace raypool::sobol
