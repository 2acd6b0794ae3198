/// Camera paths are each named once and in order, however they are taken.
#include "wavefront/camera_paths.h"

#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::wavefront {
namespace {

using test::RandomInputs;

template <class Scalar>
using Native = Wide<Scalar, stdx::native_simd<Scalar>::size()>;

constexpr std::int64_t kImageWidth = 29;

/// x, y, pixel, sample.
using Path = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

struct Samples {
    PixelRange range;
    std::int64_t first_sample;
    std::int64_t end_sample;

    [[nodiscard]] CameraPaths paths() const { return {range, kImageWidth, first_sample, end_sample}; }
    [[nodiscard]] std::vector<Path> in_order() const {
        std::vector<Path> all;
        for (std::int64_t y = range.y_begin; y < range.y_end; ++y)
            for (std::int64_t x = range.x_begin; x < range.x_end; ++x)
                for (std::int64_t s = first_sample; s < end_sample; ++s) all.emplace_back(x, y, y * kImageWidth + x, s);
        return all;
    }
};
const std::vector<Samples> kSamples{{{0, 29, 0, 5}, 0, 1},  {{0, 29, 0, 5}, 0, 3},   {{16, 29, 16, 19}, 0, 7},
                                    {{3, 4, 2, 13}, 0, 5},  {{5, 6, 7, 8}, 0, 1},    {{5, 6, 7, 8}, 11, 500},
                                    {{0, 16, 0, 16}, 2, 3}, {{28, 29, 0, 2}, 0, 16}, {{0, 29, 3, 4}, 100, 117}};

/// Takes all of `paths` in registers of at most random sizes.
template <class Real>
void drain(CameraPaths paths, RandomInputs& random, std::vector<Path>& out) {
    while (!paths.is_done()) {
        const std::int64_t left = paths.left();
        const int most = 1 + random.below(2 * kLanes<Real>);  // more than a register is a register
        const CameraLanes<Real> lanes = paths.template next<Real>(static_cast<std::size_t>(most));
        ASSERT_GE(lanes.count, 1);
        ASSERT_LE(lanes.count, std::min(most, kLanes<Real>));
        ASSERT_EQ(paths.left(), left - lanes.count);
        for (int i = 0; i < lanes.count; ++i)
            out.emplace_back(lane(lanes.x, i), lane(lanes.y, i), lane(lanes.pixel, i), lane(lanes.sample, i));
    }
}

template <class Real>
class CameraPathsBy : public testing::Test {};
using Reals = testing::Types<float, Wide<float, kTreeWidth<float>>, Native<float>, Native<double>>;
TYPED_TEST_SUITE(CameraPathsBy, Reals);

TYPED_TEST(CameraPathsBy, RegistersOfAnySizeNameEachSampleOnceInOrder) {
    RandomInputs random(1);
    for (const Samples& samples : kSamples) {
        const std::vector<Path> expected = samples.in_order();
        EXPECT_EQ(samples.paths().left(), static_cast<std::int64_t>(expected.size()));
        for (int i = 0; i < 5; ++i) {
            std::vector<Path> got;
            drain<TypeParam>(samples.paths(), random, got);
            ASSERT_EQ(got, expected);
        }
    }
}

TYPED_TEST(CameraPathsBy, TakesBetweenRegistersNameEachSampleOnceInOrder) {
    RandomInputs random(2);
    for (const Samples& samples : kSamples) {
        for (int i = 0; i < 5; ++i) {
            std::vector<Path> got;
            CameraPaths paths = samples.paths();
            while (!paths.is_done()) {
                const auto most = std::min<std::int64_t>(paths.left(), random.below(100));
                drain<TypeParam>(paths.take(most), random, got);  // of none, too
                if (paths.is_done() || random.one_in(2)) continue;
                CameraPaths one = paths.take(1);
                drain<TypeParam>(one, random, got);
            }
            ASSERT_EQ(got, samples.in_order());
        }
    }
}

TYPED_TEST(CameraPathsBy, PartsAreTheSameAsSkipping) {
    RandomInputs random(3);
    for (const Samples& samples : kSamples) {
        const CameraPaths paths = samples.paths();
        const std::vector<Path> all = samples.in_order();
        for (int i = 0; i < 50; ++i) {
            const std::int64_t begin = random.below(static_cast<int>(all.size()) + 1);
            const std::int64_t count = random.below(static_cast<int>(paths.left() - begin) + 1);
            std::vector<Path> got;
            drain<TypeParam>(paths.part(begin, count), random, got);
            ASSERT_EQ(got, std::vector<Path>(all.begin() + begin, all.begin() + begin + count));
        }
        EXPECT_TRUE(paths.part(paths.left(), 0).is_done());
    }
}

TEST(CameraPaths, OfTheLargestImageKeepTheirNumbers) {
    const std::int64_t edge = 65536;
    const CameraPaths paths({0, edge, 0, edge}, edge, 0, (std::int64_t{1} << 31) - 1);
    CameraPaths end = paths.part(paths.left() - 1, 1);
    const CameraLanes<float> last = end.next<float>(1);
    EXPECT_EQ(last.x, edge - 1);
    EXPECT_EQ(last.y, edge - 1);
    EXPECT_EQ(last.pixel, 0xffffffffU);
    EXPECT_EQ(last.sample, 0x7ffffffeU);
}

}  // namespace
}  // namespace raypool::wavefront
