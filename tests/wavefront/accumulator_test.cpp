/// The sums of integer accumulators are exact, whoever adds what when; those of real numbers are only close.
#include "wavefront/accumulator.h"

#include <omp.h>

#include <numeric>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::wavefront {
namespace {

using test::RandomInputs;

constexpr std::int64_t kWidth = 5;
constexpr std::int64_t kHeight = 3;
constexpr std::size_t kPixels = kWidth * kHeight;
constexpr int kThreads = 4;
constexpr std::size_t kContributions = 8192;
constexpr double kMostRadiance = 1000;
constexpr std::int64_t kBefore = 12345;  ///< what every sum of the framebuffer holds at first

struct Contribution {
    std::uint32_t pixel;
    Vec3<float> radiance;
};

std::vector<Contribution> contributions(std::uint64_t seed) {
    RandomInputs random(seed);
    std::vector<Contribution> all;
    for (std::size_t i = 0; i < kContributions; ++i) {
        Vec3<float> radiance;
        for (int k = 0; k < 3; ++k) radiance[k] = static_cast<float>(std::exp(random.uniform(-12, 6)));
        all.push_back({static_cast<std::uint32_t>(random.below(kPixels)), radiance});
    }
    return all;
}

Framebuffer framebuffer() {
    Framebuffer out(kWidth, kHeight, FixedPoint::make(kContributions, kMostRadiance));
    for (std::int64_t& sum : out.sums()) sum = kBefore;
    return out;
}

std::vector<std::int64_t> sums_of(const Framebuffer& framebuffer) {
    return {framebuffer.sums().begin(), framebuffer.sums().end()};
}

std::vector<std::int64_t> expected_sums(const std::vector<Contribution>& all) {
    Framebuffer out = framebuffer();
    SampleConverter converter(out.fixed_point());
    for (const Contribution& contribution : all) out.add(contribution.pixel, converter.convert(contribution.radiance));
    return sums_of(out);
}

/// All threads at once add to `accumulator`, a few contributions at a time, in an order made by `seed`. With `owned`
/// each thread adds what belongs to its own pixels, otherwise whatever comes.
void add_all(AccumulatorBase<float>& accumulator, const FixedPoint& fixed, const std::vector<Contribution>& all,
             std::uint64_t seed, bool owned) {
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    RandomInputs random(seed);
    for (std::size_t i = order.size() - 1; i > 0; --i)
        std::swap(order[i], order[static_cast<std::size_t>(random.below(static_cast<int>(i + 1)))]);
#pragma omp parallel num_threads(kThreads)
    {
        const int thread = omp_get_thread_num();
        const auto threads = static_cast<std::size_t>(omp_get_num_threads());
        SampleConverter converter(fixed);
        Contributions<float> some;
        some.reserve(64);
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Contribution& contribution = all[order[i]];
            if ((owned ? contribution.pixel : i) % threads != static_cast<std::size_t>(thread)) continue;
            some.put<float>(contribution.pixel, contribution.radiance, 1);
            if (some.count() < 64) continue;
            accumulator.add(some, converter, thread);
            some.clear();
        }
        accumulator.add(some, converter, thread);
    }
}

class Exact : public testing::TestWithParam<Accumulator> {};

TEST_P(Exact, SumsDoNotDependOnOrderNorOnContention) {
    const std::vector<Contribution> all = contributions(1);
    const std::vector<std::int64_t> expected = expected_sums(all);
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        Framebuffer out = framebuffer();
        const auto accumulator = make_accumulator<float>(GetParam(), out, kThreads);
        add_all(*accumulator, out.fixed_point(), all, seed, needs_owned_pixels(GetParam()));
        merge_all(*accumulator);
        ASSERT_EQ(sums_of(out), expected);
    }
}

TEST_P(Exact, SumsLeaveBadSamplesOutWholeAndAccountForThem) {
    Framebuffer out = framebuffer();
    const auto accumulator = make_accumulator<float>(GetParam(), out, 1);
    SampleConverter converter(out.fixed_point());
    Contributions<float> some;
    some.reserve(2);
    some.put<float>(2, vec3<float>(1, std::numeric_limits<float>::quiet_NaN(), 1), 1);
    some.put<float>(3, vec3<float>(1, 1, std::numeric_limits<float>::infinity()), 1);
    accumulator->add(some, converter, 0);
    merge_all(*accumulator);
    EXPECT_EQ(converter.statistics().non_finite, 2);
    EXPECT_EQ(sums_of(out), sums_of(framebuffer()));
}

INSTANTIATE_TEST_SUITE_P(Accumulators, Exact,
                         testing::Values(Accumulator::OwnedInt64, Accumulator::AtomicInt64, Accumulator::PrivateInt64,
                                         Accumulator::OwnedPlanarInt64, Accumulator::AtomicPlanarInt64));

class Rounded : public testing::TestWithParam<std::pair<Accumulator, double>> {};

TEST_P(Rounded, SumsAreCloseToTheExactOnesAndReachTheFramebufferInTheEnd) {
    const auto [kind, tolerance] = GetParam();
    const std::vector<Contribution> all = contributions(2);
    const std::vector<std::int64_t> expected = expected_sums(all);
    Framebuffer out = framebuffer();
    const auto accumulator = make_accumulator<float>(kind, out, kThreads);
    add_all(*accumulator, out.fixed_point(), all, 3, false);
    EXPECT_EQ(sums_of(out), sums_of(framebuffer())) << "nothing is there before merge()";
    merge_all(*accumulator);
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(static_cast<double>(out.sums()[i]), static_cast<double>(expected[i]),
                    tolerance * static_cast<double>(expected[i]));
}

INSTANTIATE_TEST_SUITE_P(Accumulators, Rounded,
                         testing::Values(std::pair{Accumulator::AtomicFloat, 1e-4},
                                         std::pair{Accumulator::AtomicDouble, 1e-9}));

TEST(Layouts, KeepEverySumOfEveryPixelInAPlaceOfItsOwn) {
    std::vector<std::int64_t> sums(3 * kPixels);
    const auto places = [&](const auto& layout) {
        std::vector<std::ptrdiff_t> all;
        for (std::size_t pixel = 0; pixel < kPixels; ++pixel)
            for (int k = 0; k < 3; ++k) all.push_back(&layout.at(pixel, k) - sums.data());
        return all;
    };
    std::vector<std::ptrdiff_t> expected(sums.size());
    std::iota(expected.begin(), expected.end(), std::ptrdiff_t{0});
    EXPECT_EQ(places(Interleaved{sums.data()}), expected);
    std::vector<std::ptrdiff_t> planar = places(Planar{sums.data(), kPixels});
    EXPECT_EQ(planar[1] - planar[0], std::ptrdiff_t{kPixels}) << "green is in the next plane";
    EXPECT_EQ(planar[3] - planar[0], 1) << "the next pixel is the neighbour";
    std::sort(planar.begin(), planar.end());
    EXPECT_EQ(planar, expected);
}

TEST(Accumulators, SayHowMuchMemoryTheyTakeBesideTheFramebuffer) {
    const Framebuffer out = framebuffer();
    const auto bytes = [&](Accumulator kind) { return accumulator_bytes(kind, out, kThreads); };
    EXPECT_EQ(bytes(Accumulator::OwnedInt64), 0U);
    EXPECT_EQ(bytes(Accumulator::AtomicInt64), 0U);
    EXPECT_EQ(bytes(Accumulator::PrivateInt64),
              kThreads * (3 * kPixels * sizeof(std::int64_t) + block_count_of(kPixels)));
    EXPECT_EQ(bytes(Accumulator::OwnedPlanarInt64), 3 * kPixels * sizeof(std::int64_t));
    EXPECT_EQ(bytes(Accumulator::AtomicPlanarInt64), 3 * kPixels * sizeof(std::int64_t));
    EXPECT_EQ(bytes(Accumulator::AtomicFloat), 3 * kPixels * sizeof(float));
    EXPECT_EQ(bytes(Accumulator::AtomicDouble), 3 * kPixels * sizeof(double));
}

TEST(Contributions, KeepTheLanesAskedForInOrder) {
    using Real = Wide<float, stdx::native_simd<float>::size()>;
    RandomInputs random(4);
    Contributions<float> all;
    constexpr int kRegisters = 20;
    all.reserve(kRegisters * kLanes<Real>);
    std::vector<std::uint32_t> expected;
    for (int i = 0; i < kRegisters; ++i) {
        Uint32<Real> pixel;
        for (int k = 0; k < kLanes<Real>; ++k) pixel[k] = random.word() >> 9U;
        const Real red = from_uint32<Real>(pixel);
        const unsigned bits = random.word() & ((1U << kLanes<Real>)-1);
        all.put<Real>(pixel, vec3<Real>(red, red + Real(1), red + Real(2)), bits);
        for (int k = 0; k < kLanes<Real>; ++k)
            if ((bits >> k & 1U) != 0) expected.push_back(pixel[k]);
    }
    ASSERT_EQ(all.count(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(all.pixel(i), expected[i]);
        const auto red = static_cast<float>(expected[i]);
        EXPECT_EQ(all.radiance(i), vec3<float>(red, red + 1, red + 2));
    }
}

}  // namespace
}  // namespace raypool::wavefront
