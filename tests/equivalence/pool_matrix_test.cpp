// One image, continued: every pool makes the sums that recursion makes, with every knob in every position.
//
// A sample of the matrix runs by default. RAYPOOL_MATRIX_STRIDE=1 runs all of it (scripts/hash_matrix).

#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>
#include <vector>

#include "core/base/error.h"
#include "tests/equivalence/every_nth.h"
#include "tests/equivalence/same_image.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

namespace raypool {
namespace {

using namespace wavefront;

struct PoolCase {
    const char* scene;
    std::int64_t width;
    std::int64_t height;
    std::int64_t spp;
    std::int32_t depth;
};

const std::vector<PoolCase> kCases{{"paper", 24, 14, 4, 50},       {"mirror_corridor", 5, 3, 1, 1000},
                                   {"glass_stack", 20, 15, 4, 50}, {"cornell", 16, 16, 8, 50},
                                   {"textures", 24, 14, 3, 50},    {"one_sphere", 1, 1, 100, 50}};

struct Knobs {
    RenderSettings settings;
    PoolSettings pool;
};

std::string describe(const Knobs& knobs) {
    const auto& [settings, pool] = knobs;
    return fmt::format(
        "{} threads, schedule {},{}, scope {}, refill {}, width {}, intersection {}, camera {}, sort {}, append {}, "
        "accumulator {}, {} rays, batch {}",
        settings.threads, static_cast<int>(settings.schedule.kind), settings.schedule.chunk,
        static_cast<int>(pool.scope), static_cast<int>(pool.refill), static_cast<int>(pool.width),
        static_cast<int>(pool.intersection), static_cast<int>(pool.camera), static_cast<int>(pool.sort),
        static_cast<int>(pool.append), static_cast<int>(pool.accumulator), pool.capacity, pool.batch);
}

/// All positions of all knobs. `whole` is a capacity that holds every path of the image.
std::vector<Knobs> matrix(const RenderSettings& base, std::int64_t whole) {
    std::vector<Knobs> list;
    for (const int threads : {1, 2, 3, 7})
        for (const LoopSchedule schedule : {LoopSchedule{LoopSchedule::Kind::Static, 0},
                                            {LoopSchedule::Kind::Static, 1},
                                            {LoopSchedule::Kind::Dynamic, 0},
                                            {LoopSchedule::Kind::Guided, 2},
                                            {LoopSchedule::Kind::Tasks, 3},
                                            {LoopSchedule::Kind::Balanced, 0}})
            for (const std::int64_t rays :
                 {std::int64_t{1}, std::int64_t{15}, std::int64_t{17}, std::int64_t{1000}, std::int64_t{8192}, whole})
                for (const Refill refill : {Refill::Drain, Refill::Regenerate})
                    for (const Sort sort : {Sort::None, Sort::Material})
                        for (const CameraStage camera : {CameraStage::Staged, CameraStage::Fused, CameraStage::Beam})
                            for (const auto& [width, intersection] :
                                 {std::pair{StageWidth::Scalar, Intersection::Single},
                                  std::pair{StageWidth::Simd, Intersection::Single},
                                  std::pair{StageWidth::Simd, Intersection::Stream},
                                  std::pair{StageWidth::Simd, Intersection::Pairs}}) {
                                Knobs knobs{base, {}};
                                knobs.settings.threads = threads;
                                knobs.settings.schedule = schedule;
                                PoolSettings& pool = knobs.pool;
                                pool.capacity = rays;
                                pool.refill = refill;
                                pool.sort = sort;
                                pool.camera = camera;
                                pool.width = width;
                                pool.intersection = intersection;
                                for (const Accumulator accumulator : {Accumulator::OwnedInt64, Accumulator::AtomicInt64,
                                                                      Accumulator::OwnedPlanarInt64}) {
                                    pool.accumulator = accumulator;
                                    list.push_back(knobs);
                                }
                                pool.scope = PoolScope::Shared;
                                pool.batch = 64;
                                for (const auto& [append, accumulator] :
                                     {std::pair{Append::InPlace, Accumulator::AtomicInt64},
                                      {Append::Atomic, Accumulator::PrivateInt64},
                                      {Append::PrefixSum, Accumulator::AtomicPlanarInt64}}) {
                                    pool.append = append;
                                    pool.accumulator = accumulator;
                                    list.push_back(knobs);
                                }
                            }
    return list;
}

/// How many entries of the matrix to go on by. 1 is all; a prime that divides no dimension meets every knob otherwise.
std::size_t stride() {
#ifdef NDEBUG
    constexpr std::size_t kSample = 353;
#else
    constexpr std::size_t kSample = 1009;  // sanitizers are slow
#endif
    const char* wanted = std::getenv("RAYPOOL_MATRIX_STRIDE");
    if (wanted == nullptr) return kSample;
    const std::size_t stride = std::strtoul(wanted, nullptr, 10);
    RAYPOOL_CHECK(std::gcd(stride, std::size_t{6}) == 1, "RAYPOOL_MATRIX_STRIDE is 1 or a prime above 3");
    return stride;
}

class PoolMatrix : public testing::TestWithParam<PoolCase> {};

TEST_P(PoolMatrix, EveryPoolMakesTheImageThatRecursionMakes) {
    const PoolCase& test = GetParam();
    const CompiledScene<float> scene = compile<float>(small_scene(test.scene, test.width, test.height));
    for (const int split_depth : {0, 2}) {
        RenderSettings settings;
        settings.end_sample = test.spp;
        settings.depth = test.depth;
        settings.split_depth = split_depth;
        settings.sampler = split_depth == 0 ? Sampler::Independent : Sampler::Sobol;
        settings.roulette = split_depth != 0;
        const Rendered expected = render(recursive::RecursiveEngine(), scene, settings);
        const Rendered iterative = render(recursive::IterativeEngine(), scene, settings);
        ASSERT_TRUE(same_image(test.scene, expected, iterative, "iterative"));

        const std::vector<Knobs> all = matrix(settings, scene.pixel_count() * test.spp);
        std::size_t tried = 0;
        for (std::size_t i = static_cast<std::size_t>(split_depth) % stride(); i < all.size(); i += stride()) {
            const Rendered got = render(WavefrontEngine(all[i].pool), scene, all[i].settings);
            ASSERT_TRUE(same_image(test.scene, expected, got, describe(all[i])));
            ASSERT_EQ(expected.report.segments(), got.report.segments()) << describe(all[i]);
            ++tried;
        }
        RecordProperty(fmt::format("tried_split_{}", split_depth), static_cast<int>(tried));
        fmt::print("{}, split depth {}: {} pools, one hash {}\n", test.scene, split_depth, tried, expected.hash());
    }
}

/// With the sampler and roulette in every position, and with glass that splits paths.
template <class Scalar>
void expect_one_image_of_all_rungs(const PoolCase& test) {
    const CompiledScene<Scalar> scene = compile<Scalar>(small_scene(test.scene, test.width, test.height));
    EveryNth some(7);
    for (const Sampler sampler : {Sampler::Independent, Sampler::Sobol}) {
        for (const bool roulette : {false, true}) {
            for (const int split_depth : {0, 2}) {
                RenderSettings settings;
                settings.end_sample = test.spp;
                settings.depth = test.depth;
                settings.sampler = sampler;
                settings.roulette = roulette;
                settings.split_depth = split_depth;
                const Rendered expected = render(recursive::RecursiveEngine(), scene, settings);
                EXPECT_EQ(expected.report.statistics.clamped, 0);
                settings.threads = 3;
                for (const Rung& rung : ladder(settings.threads)) {
                    if (!some.takes_next()) continue;
                    const Rendered got = render(WavefrontEngine(rung.pool), scene, settings);
                    const std::string how = fmt::format("{}, sampler {}, roulette {}, split depth {}", rung.name,
                                                        static_cast<int>(sampler), roulette, split_depth);
                    EXPECT_TRUE(same_image(test.scene, expected, got, how));
                    EXPECT_EQ(expected.report.segments(), got.report.segments()) << how;
                }
            }
        }
    }
}

TEST_P(PoolMatrix, EveryRungOfTheLadderMakesTheSameImage) {
    expect_one_image_of_all_rungs<float>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Scenes, PoolMatrix, testing::ValuesIn(kCases),
                         [](const auto& param) { return std::string(param.param.scene); });

TEST(PoolEquivalence, DoublePrecisionAgreesToo) {
    expect_one_image_of_all_rungs<double>({"paper", 20, 11, 3, 50});
    expect_one_image_of_all_rungs<double>({"cornell", 12, 12, 2, 50});
}

TEST(PoolEquivalence, SharedPoolUnderContentionMakesOneImage) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 32));
    RenderSettings settings;
    settings.end_sample = 4;
    const Rendered expected = render(recursive::RecursiveEngine(), scene, settings);
    settings.threads = 4;
    settings.schedule = {LoopSchedule::Kind::Dynamic, 1};
    for (const Append append : {Append::InPlace, Append::Atomic, Append::PrefixSum}) {
        for (const Accumulator accumulator :
             {Accumulator::AtomicInt64, Accumulator::PrivateInt64, Accumulator::AtomicPlanarInt64}) {
            PoolSettings pool{.scope = PoolScope::Shared,
                              .refill = Refill::Regenerate,
                              .append = append,
                              .accumulator = accumulator,
                              .capacity = 512,
                              .batch = 16};
            for (int i = 0; i < 3; ++i)
                ASSERT_TRUE(
                    same_image("paper", expected, render(WavefrontEngine(pool), scene, settings), "contention"));
        }
    }
}

}  // namespace
}  // namespace raypool
