/// Inputs for tests of numeric code: seeded, the same on every machine, and with the numbers that break arithmetic.
///
/// The arguments of a call are evaluated in any order, so a test draws no two numbers in one argument list.
/// kInputs is how many a test draws: a million in a release build, few where nothing is optimised or all is checked.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>

#include "core/math/vec.h"

namespace raypool::test {

#ifdef NDEBUG
inline constexpr int kInputs = 1'000'000;
#else
inline constexpr int kInputs = 20'000;
#endif
/// How many a statistical test draws: the same in every build, so that what passes once passes always.
inline constexpr int kDraws = 1'000'000;

class RandomInputs {
  public:
    explicit RandomInputs(std::uint64_t seed) : state_(seed) {}

    /// splitmix64 (Steele et al. 2014); unrelated to core/math/random.h, which is among what is tested.
    std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    std::uint32_t word() { return static_cast<std::uint32_t>(bits() >> 32U); }
    int below(int count) { return static_cast<int>((bits() >> 32U) * static_cast<std::uint64_t>(count) >> 32U); }
    bool one_in(int count) { return below(count) == 0; }

    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(bits() >> 11U) * 0x1p-53);
    }

    /// As drawn for paths: a multiple of 2^-24 below one.
    template <class Scalar>
    Scalar unit_interval() {
        return static_cast<Scalar>(static_cast<float>(bits() >> 40U) * 0x1p-24F);
    }
    template <class Scalar>
    std::array<Scalar, 2> unit_square() {
        const Scalar u = unit_interval<Scalar>();
        return {u, unit_interval<Scalar>()};
    }
    /// Any bit pattern: not-a-numbers, infinities and denormals too.
    template <class Scalar>
    Scalar any() {
        if constexpr (sizeof(Scalar) == 4) {
            return std::bit_cast<float>(word());
        } else {
            return std::bit_cast<double>(bits());
        }
    }
    /// Either sign, log-uniform in absolute value within [2^low, 2^high).
    template <class Scalar>
    Scalar magnitude(int low, int high) {
        const int exponent = low + below(high - low);
        const double value = std::ldexp(uniform(1, 2), exponent);
        return static_cast<Scalar>(one_in(2) ? value : -value);
    }
    template <class Scalar>
    Scalar special() {
        using Limits = std::numeric_limits<Scalar>;
        constexpr Scalar kOne = 1;
        const Scalar above_one = kOne + Limits::epsilon();
        const Scalar below_one = kOne - Limits::epsilon() / 2;
        const std::array<Scalar, 20> values{0,
                                            Limits::denorm_min(),
                                            Limits::min(),
                                            Limits::max(),
                                            Limits::infinity(),
                                            Limits::quiet_NaN(),
                                            1,
                                            above_one,
                                            below_one,
                                            Scalar(0.5),
                                            2,
                                            1000,
                                            Scalar(1e-12),
                                            Scalar(1e-20),
                                            Scalar(1e20),
                                            Scalar(1e-6),
                                            3,
                                            0,
                                            1,
                                            Scalar(1e9)};
        const Scalar value = values[below(values.size())];
        return one_in(2) ? value : -value;
    }

    template <class Scalar>
    Vec3<Scalar> point(double half_edge) {
        const double x = uniform(-half_edge, half_edge), y = uniform(-half_edge, half_edge);
        return vec3<Scalar>(Scalar(x), Scalar(y), Scalar(uniform(-half_edge, half_edge)));
    }
    /// A point whose coordinates are whole, small and often zero, of either sign.
    template <class Scalar>
    Vec3<Scalar> lattice_point(int most) {
        Vec3<Scalar> p;
        for (int i = 0; i < 3; ++i) p[i] = std::copysign(Scalar(below(most + 1)), one_in(2) ? Scalar(1) : Scalar(-1));
        return p;
    }
    /// Uniform, of length one to rounding.
    template <class Scalar>
    Vec3<Scalar> direction() {
        const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
        return vec3<Scalar>(Scalar(r * std::cos(angle)), Scalar(r * std::sin(angle)), Scalar(z));
    }

  private:
    std::uint64_t state_;
};

}  // namespace raypool::test
