/// The operations of core/math/real.h: what they promise, and that a lane of a register gets what a single number gets.
#include "core/math/real.h"

#include <gtest/gtest.h>

#include "tests/core/math/lane_agreement.h"
#include "tests/core/math/operations.h"

namespace raypool::test {
namespace {

TEST(RealOperations, AgreeInEveryLaneOnAnyBitPattern) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const bool is_tame = random.one_in(2);
        for (int i = 0; i < 3; ++i) row.real(is_tame ? random.magnitude<S>(-12, 12) : random.any<S>());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Real a = in.real();
        const Real b = in.real();
        const Real c = in.real();
        out(mad<Real>(a, b, c)), out(nmad<Real>(a, b, c));
        out(min(a, b)), out(max(a, b));
        out(sqrt(a)), out(floor(a)), out(abs(a)), out(copysign(a, b));
        out(a + b), out(a - b), out(a * b), out(a / b), out(-a);
        out(select(a < b, b, c)), out(select(!(a <= b) || b == c, a, c));
        out.mask(a < b && b < c), out.mask(a >= b || c != a), out.mask(!(a == b));
    });
}

TEST(RealOperations, AgreeInEveryLaneOnZerosInfinitiesAndNotANumbers) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        for (int i = 0; i < 3; ++i) row.real(random.special<S>());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Real a = in.real();
        const Real b = in.real();
        const Real c = in.real();
        out(min(a, b)), out(max(a, b)), out(copysign(a, b)), out(floor(a)), out(abs(a));
        out(mad<Real>(a, b, c)), out(nmad<Real>(a, b, c)), out(sqrt(a)), out(a / b);
    });
}

TEST(RealOperations, ConvertAlikeInEveryLane) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        row.word(random.word() >> 1U);
        const auto shift = static_cast<unsigned>(1 + random.below(31));
        row.word(random.word() >> shift);
        row.word(random.word());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Int<Real> a = in.index();
        const Int<Real> b = in.index();
        const Uint32<Real> word = in.word();
        const Real third(ScalarOf<Real>(1) / 3);
        out(to_real<Real>(a)), out(to_real<Real>(-b));
        out.whole(to_int<Real>(to_real<Real>(a) * third)), out.whole(to_int<Real>(to_real<Real>(-b) * third));
        out(from_uint32<Real>(word >> 1)), out(from_uint32<Real>(word >> 8));
        out.mask(as_mask<Real>(a < b)), out.mask(as_mask<Real>(a == b));
        out(select(as_mask<Real>(a <= b), third, Real(0)));
    });
}

constexpr int kRows = 37;
constexpr int kStride = 12;
template <class Scalar>
const std::vector<Scalar> kTable = [] {
    std::vector<Scalar> table(kRows * kStride);
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<Scalar>(i);
    return table;
}();

TEST(RealOperations, LoadTheRowsThatTheIndicesName) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) { row.word(random.below(kRows)); };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const auto& table = kTable<ScalarOf<Real>>;
        const Int<Real> id = in.index();
        Real twelve[12];
        Real four[4];
        load_rows<12, Real>(table.data(), kStride, id, twelve);
        load_rows<4, Real>(table.data(), kStride, id, four);
        for (const Real& value : twelve) out(value);
        for (const Real& value : four) out(value);
    });
}

TEST(RealOperations, MinimumAndMaximumTakeTheSecondUnlessTheFirstIsStrictlyBetter) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(min(nan, 1.0F), 1.0F);
    EXPECT_EQ(max(nan, 1.0F), 1.0F);
    EXPECT_TRUE(std::isnan(min(1.0F, nan)));
    EXPECT_TRUE(std::isnan(max(1.0F, nan)));
    EXPECT_TRUE(std::signbit(min(0.0F, -0.0F)));
    EXPECT_FALSE(std::signbit(max(-0.0F, 0.0F)));
}

TEST(RealOperations, FuseMultiplicationAndAddition) {
    const float a = 1 + 0x1p-12F;
    EXPECT_EQ(mad(a, a, -1.0F), 0x1p-11F + 0x1p-24F);
    EXPECT_EQ(nmad(a, a, 1.0F), -(0x1p-11F + 0x1p-24F));
}

/// Every pattern of a mask: its bits, and the questions asked of all lanes at once.
template <class Real>
void expect_masks_tell_their_bits() {
    constexpr unsigned kPatterns = 1U << kLanes<Real>;
    for (unsigned pattern = 0; pattern < kPatterns; ++pattern) {
        ScalarOf<Real> sign[kLanes<Real>];
        for (int i = 0; i < kLanes<Real>; ++i) sign[i] = (pattern >> i & 1U) != 0 ? 1 : -1;
        const Mask<Real> mask = Real(sign, stdx::element_aligned) > Real(0);
        ASSERT_EQ(mask_bits(mask), pattern);
        ASSERT_EQ(mask_bits(!mask), kPatterns - 1 - pattern);
        ASSERT_EQ(any(mask), pattern != 0);
        ASSERT_EQ(all(mask), pattern == kPatterns - 1);
        ASSERT_EQ(none(mask), pattern == 0);
        ASSERT_EQ(all(!mask), pattern == 0);
    }
}

TEST(RealOperations, MasksTellTheBitOfEachLane) {
    expect_masks_tell_their_bits<stdx::native_simd<float>>();
    expect_masks_tell_their_bits<Wide<float, kTreeWidth<float>>>();
    expect_masks_tell_their_bits<stdx::native_simd<double>>();
}

/// Every pattern of lanes, and both the numbers and the words that travel beside them; one register alone, and as one
/// of many.
template <class Real, class V, class T>
void expect_chosen_lanes_at_the_front(int lanes) {
    T all[16];
    for (int i = 0; i < lanes; ++i) all[i] = static_cast<T>(100 + i);
    const V v(all, stdx::element_aligned);
    for (unsigned pattern = 0; pattern < 1U << static_cast<unsigned>(lanes); ++pattern) {
        T target[32] = {};  // room for a whole vector behind the last one
        T packed[32] = {};
        compress_store(target, v, pattern);
        LanePacker<Real>(pattern).store(packed, v);
        int next = 0;
        for (int i = 0; i < lanes; ++i) {
            if ((pattern >> static_cast<unsigned>(i) & 1U) == 0) continue;
            ASSERT_EQ(target[next], all[i]) << pattern;
            ASSERT_EQ(packed[next++], all[i]) << pattern;
        }
    }
}
template <class Real>
void expect_compress_store_works() {
    expect_chosen_lanes_at_the_front<Real, Real, ScalarOf<Real>>(kLanes<Real>);
    expect_chosen_lanes_at_the_front<Real, Uint32<Real>, std::uint32_t>(kLanes<Real>);
}

TEST(RealOperations, CompressTheChosenLanesToTheFront) {
    expect_compress_store_works<stdx::native_simd<float>>();
    expect_compress_store_works<Wide<float, kTreeWidth<float>>>();
    expect_compress_store_works<stdx::native_simd<double>>();
    float target = 1;
    compress_store(&target, 2.0F, 0);
    EXPECT_EQ(target, 1);
    compress_store(&target, 2.0F, 1);
    EXPECT_EQ(target, 2);
}

template <class Real>
void expect_rows_stored_and_loaded_back() {
    constexpr int kColumns = 8;
    alignas(64) ScalarOf<Real> rows[kLanes<Real> * kColumns];
    Real column[kColumns];
    for (int k = 0; k < kColumns; ++k)
        column[k] = Real([k](auto i) { return static_cast<ScalarOf<Real>>(10 * int{i} + k); });
    store_rows<kColumns, Real>(rows, column);
    for (int i = 0; i < kLanes<Real>; ++i)
        for (int k = 0; k < kColumns; ++k) ASSERT_EQ(rows[i * kColumns + k], 10 * i + k);
    Real loaded[kColumns];
    load_rows<kColumns, Real>(rows, kColumns, Int<Real>([](auto i) { return int{i}; }), loaded);
    for (int k = 0; k < kColumns; ++k) ASSERT_TRUE(all(loaded[k] == column[k]));
}

TEST(RealOperations, StoreRowsThatLoadRowsLoads) {
    expect_rows_stored_and_loaded_back<stdx::native_simd<float>>();
    expect_rows_stored_and_loaded_back<Wide<float, kTreeWidth<float>>>();
    expect_rows_stored_and_loaded_back<stdx::native_simd<double>>();
}

TEST(FlushDenormals, HoldsForItsScopeOnly) {
    volatile float tiny = std::numeric_limits<float>::min();
    {
        const FlushDenormals flush;
        volatile float half = tiny / 2;
        EXPECT_EQ(half, 0);
    }
    volatile float half = tiny / 2;
    EXPECT_GT(half, 0);
}

template <class Real>
float product_of(float a, float b) {
    volatile float x = a;
    volatile float y = b;
    return static_cast<float>(lane(Real(x) * Real(y), 0));
}

TEST(FlushDenormals, LeavesARoundedResultOrFlushesItAsTheProcessorDoes) {
    const FlushDenormals flush;
    const float least = std::numeric_limits<float>::min();  // 2^-126
    const float kept = kJudgesBeforeRounding ? 0 : least;
    // (1 - 2^-26) 2^-126 is 2^-126 when it is rounded to 24 bits; (1 - 2^-24) 2^-126 has no more bits than that.
    const float a = (1 + 0x1p-13F) * 0x1p-63F;
    const float b = (1 - 0x1p-13F) * 0x1p-63F;
    EXPECT_EQ(product_of<float>(a, b), kept);
    EXPECT_EQ(product_of<stdx::native_simd<float>>(a, b), kept);
    EXPECT_EQ(product_of<float>(-a, b), -kept);
    EXPECT_EQ(product_of<float>((1 + 0x1p-12F) * 0x1p-63F, (1 - 0x1p-12F) * 0x1p-63F), 0);
    EXPECT_EQ(product_of<float>(1, least), least);
}

/// The same number on every processor and of every compiler: it is that of x86.
TEST(RealOperations, AreThoseOfEveryProcessor) {
    const FlushDenormals flush;
    std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a, of words
    for (std::uint32_t i = 0; i < (1U << 18U); ++i) {
        float a;
        float b;
        pair_of(i, a, b);
        std::uint32_t out[kOperations];
        operate(a, b, out);
        for (int k = 0; k < kOperations; ++k) {
            const std::uint32_t zero = out[k] & 0x80000000U;
            const bool is_exact = k == 2 && std::abs(double{a} * double{b}) >= 0x1p-126;
            if (k < kRoundedOperations && !is_exact && is_rounding_to_normal(out[k], zero)) out[k] = zero;
            hash = (hash ^ out[k]) * 0x100000001b3U;
        }
    }
    EXPECT_EQ(fmt::format("{:016x}", hash), "c621c5ce8d96bcdb");
}

}  // namespace
}  // namespace raypool::test
