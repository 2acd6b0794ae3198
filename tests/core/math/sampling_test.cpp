/// Elementary functions against long double, and warps against the distributions that they promise.
#include "core/math/sampling.h"

#include <gtest/gtest.h>

#include "tests/errors.h"
#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

constexpr long double kTurn = 2 * std::numbers::pi_v<long double>;
constexpr int kOracleInputs = kInputs / 25;  // long double functions are slow

template <class Scalar>
Errors sine_and_cosine_errors() {
    RandomInputs random(1);
    Errors errors;
    for (int i = 0; i < kOracleInputs; ++i) {
        Scalar u = static_cast<Scalar>(random.uniform(0, 1));
        if (i < 1000) u = std::nextafter(static_cast<Scalar>(i / 8 % 9) / 8, static_cast<Scalar>(i % 3));
        if (!(u >= 0 && u < 1)) continue;
        const SinCos<Scalar> got = sincos_of_turn<Scalar>(u);
        errors.add(got.sin - std::sin(kTurn * u));
        errors.add(got.cos - std::cos(kTurn * u));
    }
    return errors;
}

TEST(SineAndCosine, AreAccurate) {
    EXPECT_LT(sine_and_cosine_errors<float>().max(), 1.2e-7);
    EXPECT_LT(sine_and_cosine_errors<double>().max(), 3e-16);
    EXPECT_LT(sine_and_cosine_errors<long double>().max(), 1e-18);
}

TEST(SineAndCosine, AreExactAtQuarterTurns) {
    for (int quarter = 0; quarter < 4; ++quarter) {
        const SinCos<float> got = sincos_of_turn<float>(static_cast<float>(quarter) / 4);
        EXPECT_EQ(got.sin, quarter == 1 ? 1 : quarter == 3 ? -1 : 0);
        EXPECT_EQ(got.cos, quarter == 0 ? 1 : quarter == 2 ? -1 : 0);
    }
}

template <class Scalar>
Errors angle_errors() {
    RandomInputs random(2);
    Errors errors;
    for (int i = 0; i < kInputs; ++i) {
        const Scalar x = i % 8 == 0 ? random.lattice_point<Scalar>(2)[0] : random.magnitude<Scalar>(-20, 20);
        const Scalar y = i % 5 == 0 ? random.lattice_point<Scalar>(2)[0] : random.magnitude<Scalar>(-20, 20);
        if (x == 0 && y == 0) continue;
        const Scalar got = turn_of_angle<Scalar>(y, x);
        EXPECT_TRUE(got >= 0 && got <= 1) << x << ' ' << y;
        const long double expected = std::atan2(static_cast<long double>(y), static_cast<long double>(x)) / kTurn;
        const long double difference = std::abs(got - expected);
        errors.add(std::min(difference, std::abs(difference - 1)));  // 0 and 1 are one angle
    }
    return errors;
}

TEST(TurnOfAngle, IsAccurateInEveryQuadrant) {
    EXPECT_LT(angle_errors<float>().max(), 1.2e-7);
    EXPECT_LT(angle_errors<double>().max(), 1e-15);
}

TEST(TurnOfAngle, IsZeroForTheZeroVector) {
    EXPECT_EQ(turn_of_angle<float>(0.0F, 0.0F), 0);
}

double turn(double y, double x) {
    return std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
}
constexpr int kWarps = 2;

TEST(UnitSphere, IsUniform) {
    RandomInputs random(3);
    Grid grid;
    for (int i = 0; i < kDraws; ++i) {
        const auto [u, v] = random.unit_square<float>();
        const Vec3<float> d = unit_sphere<float>(u, v);
        grid.add((double{d[2]} + 1) / 2, turn(d[1], d[0]));
    }
    EXPECT_FALSE(is_significant(grid.p_value(), kWarps)) << grid.p_value();
}

TEST(UnitSphere, HasLengthOneAlsoAtThePoles) {
    RandomInputs random(4);
    Errors errors;
    for (int i = 0; i < kInputs; ++i) {
        float u = random.unit_interval<float>();
        if (i < 1000) u = i % 2 == 0 ? static_cast<float>(i) * 0x1p-24F : 1 - static_cast<float>(i) * 0x1p-24F;
        const auto d = unit_sphere<float>(u, random.unit_interval<float>()).cast<double>().eval();
        errors.add(d.norm() - 1);
    }
    EXPECT_LT(errors.max(), 3e-7);
}

TEST(UnitDisc, IsUniform) {
    RandomInputs random(5);
    Grid grid;
    for (int i = 0; i < kDraws; ++i) {
        const auto [u, v] = random.unit_square<float>();
        const auto [x, y] = unit_disc<float>(u, v);
        grid.add(double{x} * x + double{y} * y, turn(y, x));
    }
    EXPECT_FALSE(is_significant(grid.p_value(), kWarps)) << grid.p_value();
}

}  // namespace
}  // namespace raypool::test
