/// One ray at a time and a register of rays at a time: every operation and every kernel gives the same bits.
#include <gtest/gtest.h>

#include "core/builtin_test_scenes.h"
#include "core/camera.h"
#include "core/materials.h"
#include "core/shade.h"
#include "core/shapes.h"
#include "core/textures.h"
#include "tests/core/lane_agreement.h"

namespace raypool::test {
namespace {

// The operations of core/real.h.

constexpr auto kAnyThree = []<class S>(RandomInputs& random, Row<S>& row) {
    const bool is_tame = random.one_in(2);
    for (int i = 0; i < 3; ++i) row.real(is_tame ? random.magnitude<S>(-12, 12) : random.any<S>());
};

TEST(RealOperations, AgreeInEveryLaneOnAnyBitPattern) {
    expect_lanes_agree(kAnyThree, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Real a = in.real(), b = in.real(), c = in.real();
        out(mad<Real>(a, b, c)), out(nmad<Real>(a, b, c));
        out(min<Real>(a, b)), out(max<Real>(a, b)), out(min<Real>(a, a)), out(max<Real>(b, -b));
        out(sqrt(a)), out(floor(a)), out(abs(a)), out(copysign<Real>(a, b));
        out(a / b), out(a * b), out(a + b), out(-a);
        out(select(a < b, b, c)), out(select(!(a <= b) || b == c, a, c));
        out.mask(a < b && b < c), out.mask(a >= b || c != a), out.mask(!(a == b));
    });
}

TEST(RealOperations, AgreeInEveryLaneOnTiesOfZerosAndNotANumbers) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        for (int i = 0; i < 2; ++i) row.real(random.special<S>());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Real a = in.real(), b = in.real();
        out(min<Real>(a, b)), out(max<Real>(a, b)), out(copysign<Real>(a, b)), out(floor(a)), out(sqrt(a)), out(a / b);
    });
}

TEST(RealOperations, ConvertAlikeInEveryLane) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        row.word(random.word() >> 1U);
        row.word(random.word() >> random.below(31) >> 1U);
        row.word(random.word());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Int<Real> a = in.index(), b = in.index();
        const Uint32<Real> word = in.word();
        const Real third(ScalarOf<Real>(1) / 3);
        out(to_real<Real>(a)), out(to_real<Real>(-b));
        out.whole(to_int<Real>(to_real<Real>(b) * third)), out.whole(to_int<Real>(to_real<Real>(-b) * third));
        out(from_uint32<Real>(word >> 1)), out(from_uint32<Real>(word >> 8));
        out.mask(as_mask<Real>(a < b)), out.mask(as_mask<Real>(a == b));
        out(select(as_mask<Real>(a <= b), third, Real(0)));
    });
}

TEST(RealOperations, LoadTheRowsThatTheIndicesName) {
    constexpr int kRows = 37, kStride = 12;
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) { row.word(random.below(kRows)); };
    const auto run = [&]<class S>(S) {
        alignas(64) static S table[kRows * kStride];
        RandomInputs random(7);
        for (S& value : table) value = random.any<S>();
        return [](auto& in, auto& out) {
            using Real = std::decay_t<decltype(in.real_type())>;
            const Int<Real> id = in.index();
            Real twelve[12], four[4];
            load_rows<12, Real>(table, kStride, id, twelve);
            load_rows<4, Real>(table, kStride, id, four);
            for (const Real& value : twelve) out(value);
            for (const Real& value : four) out(value);
        };
    };
    expect_lanes_agree_for<float, stdx::native_simd<float>, Wide<float, 8>>(kInputs, fill, run(float()));
    expect_lanes_agree_for<double, stdx::native_simd<double>>(kInputs, fill, run(double()));
}
