/// Records survive storing, loading and moving to the last bit, and no store touches a record that is not its own.
#include "wavefront/ray_columns.h"

#include <bit>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::wavefront {
namespace {

using test::RandomInputs;

template <class Scalar>
using Native = Wide<Scalar, stdx::native_simd<Scalar>::size()>;

/// A record told from all others by any of its fields.
template <class Scalar>
RayRecord<Scalar> record_of(std::uint32_t id) {
    RandomInputs random(id);
    const auto number = [&] { return static_cast<Scalar>(random.uniform(-1e6, 1e6)); };
    RayRecord<Scalar> record;
    for (int i = 0; i < 3; ++i) record.ray.origin[i] = number();
    for (int i = 0; i < 3; ++i) record.ray.direction[i] = number();
    record.ray.time = number();
    for (int i = 0; i < 3; ++i) record.throughput[i] = number();
    record.key.pixel = random.word();
    record.key.sample = random.word();
    record.leaving_id = random.word();
    record.step = random.word();
    return record;
}

/// Calls visit(of a, of b) with each pair of fields.
template <Features features, class A, class B, class Visit>
void for_each_pair(A& a, B& b, Visit visit) {
    int i = 0;
    for_each_field<features>(a, [&](auto& field_of_a) {
        int k = 0;
        for_each_field<features>(b, [&](auto& field_of_b) {
            if constexpr (std::is_same_v<typename LaneOf<std::remove_cvref_t<decltype(field_of_a)>>::Type,
                                         typename LaneOf<std::remove_cvref_t<decltype(field_of_b)>>::Type>) {
                if (k == i) visit(field_of_a, field_of_b);
            }
            ++k;
        });
        ++i;
    });
}

template <Features features, class Scalar>
bool is_same(const RayRecord<Scalar>& a, const RayRecord<Scalar>& b) {
    bool is_same = true;
    for_each_pair<features>(a, b, [&](const auto& x, const auto& y) { is_same = is_same && x == y; });
    return is_same;
}

/// One register whose lane i is record_of(first_id + i).
template <Features features, class Real>
RayRecord<Real> records_of(std::uint32_t first_id) {
    RayRecord<Real> records{};
    for (int i = 0; i < kLanes<Real>; ++i) {
        const auto one = record_of<ScalarOf<Real>>(first_id + static_cast<std::uint32_t>(i));
        for_each_pair<features>(records, one, [&](auto& wide, const auto& value) {
            if constexpr (Simd<Real>) {
                wide[i] = value;
            } else {
                wide = value;
            }
        });
    }
    return records;
}

template <Features features, class Scalar>
class Filled : public RayColumns<features, Scalar> {
  public:
    explicit Filled(std::size_t capacity, std::uint32_t first_id = 0) : RayColumns<features, Scalar>(capacity) {
        for (std::size_t i = 0; i < capacity; ++i)
            this->template append<Scalar>(i, record_of<Scalar>(first_id + static_cast<std::uint32_t>(i)), 1, i + 1);
    }
    [[nodiscard]] bool holds(std::size_t i, std::uint32_t id) const {
        return is_same<features>(this->template load<Scalar>(i), record_of<Scalar>(id));
    }
};

TEST(RayRecord, HasTheSizeThatTheSceneAnnouncesAndNeverMoreThan64Bytes) {
    const auto check = []<Features features>() {
        EXPECT_EQ((record_bytes<features, float>()), ray_record_bytes(features, sizeof(float)));
        EXPECT_EQ((record_bytes<features, double>()), ray_record_bytes(features, sizeof(double)));
        EXPECT_LE((record_bytes<features, float>()), 64U);
        EXPECT_EQ((RayColumns<features, float>::bytes(1000)), ((1000 + kPadding) * record_bytes<features, float>()));
    };
    for (const Features& features : kCompiledFeatures) dispatch_features(features, check);
    const Features paper{
        .motion = true, .defocus = true, .metal = true, .fuzz = true, .dielectric = true, .checker = true};
    EXPECT_EQ(ray_record_bytes(paper, sizeof(float)), 56U);
    EXPECT_EQ(ray_record_bytes({.lights = true}, sizeof(float)), 56U);
}

template <class Setting>
class RecordColumns : public testing::Test {};

template <class R, bool motion>
struct Setting {
    using Real = R;
    static constexpr Features kFeatures{.motion = motion};
};
using Settings = testing::Types<Setting<float, false>, Setting<float, true>, Setting<Native<float>, true>,
                                Setting<Native<float>, false>, Setting<Native<double>, true>>;
TYPED_TEST_SUITE(RecordColumns, Settings);

TYPED_TEST(RecordColumns, LoadRecordsOneALane) {
    using Real = typename TypeParam::Real;
    constexpr Features kFeatures = TypeParam::kFeatures;
    constexpr std::uint32_t kCount = 40;
    const Filled<kFeatures, ScalarOf<Real>> columns(kCount);
    for (std::uint32_t first = 0; first < kCount; ++first) {  // the last registers reach into the padding
        const RayRecord<Real> loaded = columns.template load<Real>(first);
        for (int i = 0; i < kLanes<Real> && first + static_cast<std::uint32_t>(i) < kCount; ++i) {
            const auto expected = record_of<ScalarOf<Real>>(first + static_cast<std::uint32_t>(i));
            for_each_pair<kFeatures>(loaded, expected,
                                     [&](const auto& wide, const auto& value) { ASSERT_EQ(lane(wide, i), value); });
            if (!kFeatures.motion) {
                ASSERT_EQ(lane(loaded.ray.time, i), 0);
            }
        }
    }
}

TYPED_TEST(RecordColumns, AppendTheLanesAskedForInOrderAndLeaveWhatIsBehindTheEndAlone) {
    using Real = typename TypeParam::Real;
    using Scalar = ScalarOf<Real>;
    constexpr Features kFeatures = TypeParam::kFeatures;
    constexpr std::size_t kCount = 48;
    constexpr std::uint32_t kNewId = 1000;
    const RayRecord<Real> added = records_of<kFeatures, Real>(kNewId);
    RandomInputs random(1);
    for (int round = 0; round < 300; ++round) {
        Filled<kFeatures, Scalar> columns(kCount);
        const unsigned bits = round == 0 ? (1U << kLanes<Real>)-1 : random.word() & ((1U << kLanes<Real>)-1);
        const auto count = static_cast<std::size_t>(std::popcount(bits));
        const auto first = static_cast<std::size_t>(random.below(16));
        const auto end = first + count + static_cast<std::size_t>(random.below(17));  // exactly full one time in 17
        columns.template append<Real>(first, added, bits, end);

        std::size_t place = first;
        for (std::uint32_t i = 0; i < kLanes<Real>; ++i) {
            if ((bits >> i & 1U) != 0) {
                ASSERT_TRUE(columns.holds(place++, kNewId + i)) << "lane " << i;
            }
        }
        for (std::size_t i = 0; i < first; ++i) ASSERT_TRUE(columns.holds(i, static_cast<std::uint32_t>(i)));
        for (std::size_t i = end; i < kCount; ++i)
            ASSERT_TRUE(columns.holds(i, static_cast<std::uint32_t>(i)))
                << i << " is at or behind the end " << end << ", bits " << bits << " from " << first;
    }
}

TYPED_TEST(RecordColumns, CopyAndPermuteWholeRecordsAndNothingElse) {
    using Scalar = ScalarOf<typename TypeParam::Real>;
    constexpr Features kFeatures = TypeParam::kFeatures;
    constexpr std::uint32_t kOther = 1000;
    const Filled<kFeatures, Scalar> from(37);
    for (const std::uint32_t count : {0U, 1U, 16U, 30U}) {
        Filled<kFeatures, Scalar> to(53, kOther);
        from.copy_to(to, 20, 7, count);
        for (std::uint32_t i = 0; i < 53; ++i) {
            const bool is_copied = i >= 20 && i < 20 + count;
            ASSERT_TRUE(to.holds(i, is_copied ? i - 20 + 7 : kOther + i)) << i;
        }
    }
    Filled<kFeatures, Scalar> columns(37);
    std::vector<std::uint32_t> order(20);
    std::iota(order.begin(), order.end(), 0U);
    RandomInputs random(2);
    for (std::size_t i = order.size() - 1; i > 0; --i)
        std::swap(order[i], order[static_cast<std::size_t>(random.below(static_cast<int>(i + 1)))]);
    std::vector<double> scratch(order.size());
    columns.permute(9, order.size(), order.data(), reinterpret_cast<std::byte*>(scratch.data()));
    for (std::uint32_t i = 0; i < 37; ++i) {
        const bool is_moved = i >= 9 && i < 9 + order.size();
        ASSERT_TRUE(columns.holds(i, is_moved ? 9 + order[i - 9] : i)) << i;
    }
}

TEST(RecordColumns, OfNoRecordsCanBeCopiedFrom) {
    RayColumns<Features{}, float> none(0);
    Filled<Features{}, float> to(3);
    none.copy_to(to, 1, 0, 0);
    for (std::uint32_t i = 0; i < 3; ++i) EXPECT_TRUE(to.holds(i, i));
}

}  // namespace
}  // namespace raypool::wavefront
