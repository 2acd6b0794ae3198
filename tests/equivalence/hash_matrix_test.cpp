// One image: whatever the order of the work, the sums are the same to the last bit.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "core/math/flush_denormals.h"
#include "core/runtime/settings_text.h"
#include "tests/equivalence/every_nth.h"
#include "tests/equivalence/same_image.h"

namespace raypool {
namespace {

const recursive::RecursiveEngine kRecursive;
const recursive::IterativeEngine kIterative;
const std::vector<const Engine*> kEngines{&kRecursive, &kIterative};

struct MatrixCase {
    std::string name;
    std::string scene;
    std::int64_t width;
    std::int64_t height;
    std::int64_t spp;
    std::int32_t depth;
    Sampler sampler = Sampler::Independent;
    bool roulette = false;
    int split_depth = 0;
};

std::string describe(const Engine& engine, const RenderSettings& settings) {
    constexpr const char* kGrains[] = {"pixel", "line", "tile"};
    return fmt::format("{}, {} threads, {}, {}:{}", engine.name(), settings.threads, to_string(settings.schedule),
                       kGrains[static_cast<int>(settings.grain.kind)], settings.grain.tile);
}

/// Calls visit(settings) with every thread count, schedule, chunk and grain (EveryNth); false from it stops.
void for_every_loop(RenderSettings settings, const std::function<bool(const RenderSettings&)>& visit) {
    using Kind = LoopSchedule::Kind;
    const std::vector<Grain> grains{
        {Grain::Kind::Pixel, 1}, {Grain::Kind::Line, 1}, {Grain::Kind::Tile, 8}, {Grain::Kind::Tile, 16}};
    EveryNth some(11);
    for (const int threads : {1, 2, 3, 7}) {
        settings.threads = threads;
        settings.schedule = {Kind::Balanced, 0};
        if (!visit(settings)) return;
        for (const Kind kind : {Kind::Static, Kind::Dynamic, Kind::Guided, Kind::Tasks}) {
            for (const int chunk : {0, 1, 3}) {
                for (const Grain& grain : grains) {
                    if (!some.takes_next()) continue;
                    settings.schedule = {kind, chunk};
                    settings.grain = grain;
                    if (!visit(settings)) return;
                }
            }
        }
    }
}

RenderSettings settings_of(const MatrixCase& test) {
    RenderSettings settings;
    settings.end_sample = test.spp;
    settings.depth = test.depth;
    settings.sampler = test.sampler;
    settings.roulette = test.roulette;
    settings.split_depth = test.split_depth;
    return settings;
}

template <class Scalar>
void check_matrix(const MatrixCase& test, const std::string& file_name) {
    const CompiledScene<Scalar> scene = compile<Scalar>(small_scene(test.scene, test.width, test.height));
    const Rendered expected = render(kIterative, scene, settings_of(test));
    EXPECT_EQ(expected.report.statistics.non_finite, 0);
    EXPECT_EQ(expected.report.statistics.clamped, 0);
    for (const Engine* engine : kEngines) {
        for_every_loop(settings_of(test), [&](const RenderSettings& settings) {
            const Rendered got = render(*engine, scene, settings);
            EXPECT_EQ(got.report.segments(), expected.report.segments()) << describe(*engine, settings);
            EXPECT_EQ(got.report.paths(), test.spp * scene.pixel_count()) << describe(*engine, settings);
            EXPECT_TRUE(same_image(file_name, expected, got, describe(*engine, settings)));
            return !testing::Test::HasFailure();
        });
    }
}

class HashMatrix : public testing::TestWithParam<MatrixCase> {};

TEST_P(HashMatrix, EveryLoopAndBothFormsMakeOneImage) {
    check_matrix<float>(GetParam(), "matrix_" + GetParam().name);
}

const std::vector<MatrixCase> kCases{
    {"paper", "paper", 33, 19, 2, 50},
    {"glass_stack", "glass_stack", 24, 18, 2, 50},
    {"cornell", "cornell", 20, 20, 2, 50},
    {"textures", "textures", 33, 19, 2, 50},
    {"half_sky", "half_sky", 33, 19, 1, 50},
    {"solids", "solids", 32, 18, 2, 50},
    {"instances", "instances", 32, 18, 2, 50},
    {"split_solids", "solids", 16, 9, 2, 50, Sampler::Sobol, true, 2},
    {"smooth", "smooth", 32, 18, 2, 50},
    {"split_smooth", "smooth", 16, 9, 2, 50, Sampler::Sobol, true, 2},
    {"deep_mirror_corridor", "mirror_corridor", 17, 9, 1, 200},
    {"one_pixel_of_paper", "paper", 1, 1, 3, 50},
    {"two_pixels_of_cornell", "cornell", 2, 1, 3, 50},
    {"a_column_of_textures", "textures", 1, 40, 1, 50},
    {"no_depth", "paper", 9, 5, 1, 0},
    {"only_camera_rays", "paper", 9, 5, 1, 1},
    {"paper_by_sobol", "paper", 24, 14, 2, 50, Sampler::Sobol},
    {"cornell_by_roulette", "cornell", 16, 16, 2, 50, Sampler::Independent, true},
    {"split_glass_by_sobol_and_roulette", "glass_stack", 16, 12, 2, 50, Sampler::Sobol, true, 2},
};
INSTANTIATE_TEST_SUITE_P(Scenes, HashMatrix, testing::ValuesIn(kCases),
                         [](const auto& test) { return test.param.name; });

class HashMatrixInDouble : public testing::TestWithParam<MatrixCase> {};

TEST_P(HashMatrixInDouble, EveryLoopAndBothFormsMakeOneImage) {
    check_matrix<double>(GetParam(), "matrix_double_" + GetParam().name);
}
INSTANTIATE_TEST_SUITE_P(
    Scenes, HashMatrixInDouble,
    testing::Values(MatrixCase{"paper", "paper", 17, 9, 1, 50}, MatrixCase{"textures", "textures", 17, 9, 1, 50},
                    MatrixCase{"solids", "solids", 16, 9, 1, 50}, MatrixCase{"smooth", "smooth", 16, 9, 1, 50},
                    MatrixCase{"cornell_by_sobol_and_roulette", "cornell", 12, 12, 2, 50, Sampler::Sobol, true}),
    [](const auto& test) { return test.param.name; });

class OneImage : public testing::TestWithParam<std::string> {};

TEST_P(OneImage, IsTheSumOfItsSampleRanges) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 32));
    RenderSettings settings;
    settings.end_sample = 7;
    settings.threads = 2;
    const Rendered whole = render(kRecursive, scene, settings);

    Framebuffer parts(scene.width, scene.height, whole.framebuffer.fixed_point());
    std::int64_t segments = 0;
    for (const auto& [first, end] : {std::pair{0, 3}, {3, 4}, {4, 7}}) {
        settings.first_sample = first;
        settings.end_sample = end;
        EXPECT_NE(parts.hash(), whole.hash());
        segments += kRecursive.render(scene, settings, parts).segments();
    }
    EXPECT_EQ(parts.hash(), whole.hash());
    EXPECT_EQ(segments, whole.report.segments());
}

TEST_P(OneImage, IsAnotherForAnotherSeed) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 16));
    RenderSettings settings;
    const Rendered first = render(kIterative, scene, settings);
    for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{1} << 32U, ~std::uint64_t{0}}) {
        settings.seed = seed;
        EXPECT_NE(render(kIterative, scene, settings).hash(), first.hash()) << seed;
    }
}

TEST_P(OneImage, CountsTheSameWorkInAnyLoopAndCountingChangesNoBit) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 16));
    RenderSettings settings;
    const Rendered uncounted = render(kIterative, scene, settings);
    EXPECT_EQ(uncounted.report.total(&ThreadReport::box_tests), 0);
    EXPECT_EQ(uncounted.report.total(&ThreadReport::primitive_tests), 0);

    settings.count_work = true;
    const Rendered counted = render(kIterative, scene, settings);
    EXPECT_TRUE(same_image("counted_" + GetParam(), uncounted, counted, "counting"));
    EXPECT_GE(counted.report.total(&ThreadReport::primitive_tests), counted.report.segments());
    for (const Engine* engine : kEngines) {
        for (const LoopSchedule schedule : {LoopSchedule{LoopSchedule::Kind::Static, 1},
                                            LoopSchedule{LoopSchedule::Kind::Tasks, 0}, LoopSchedule{}}) {
            for (const int threads : {1, 3}) {
                settings.schedule = schedule;
                settings.threads = threads;
                const RenderReport report = render(*engine, scene, settings).report;
                EXPECT_EQ(report.segments(), counted.report.segments());
                for (const auto figure : {&ThreadReport::box_tests, &ThreadReport::primitive_tests})
                    EXPECT_EQ(report.total(figure), counted.report.total(figure)) << describe(*engine, settings);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, OneImage, testing::Values("paper", "cornell", "textures", "mirror_corridor"),
                         [](const auto& test) { return test.param; });

TEST(OneImage, DoesNotDependOnHowItsThreadTreatsDenormals) {
    // A path in a grey cavity halves its throughput at every hit until it is no normal number.
    Scene cavity = small_scene("one_sphere", 4, 4);
    cavity.planes.clear();
    cavity.camera.look_from = cavity.spheres[0].center0;
    cavity.textures[static_cast<std::size_t>(cavity.materials[0].texture_id)].even = Vector3d(0.5, 0.5, 0.5);
    cavity.spheres[0].material_id = 0;
    const CompiledScene<float> scene = compile<float>(cavity);
    RenderSettings settings;
    settings.depth = 1000;

    const std::uint64_t before = floating_point_modes();
    const Rendered expected = render(kIterative, scene, settings);
    EXPECT_EQ(floating_point_modes(), before) << "the caller's floating-point mode was changed";
    // 2^-126 is the least normal float: the 127th hit leaves nothing, and the path ends there.
    EXPECT_EQ(expected.report.segments(), 127 * expected.report.paths());

    const FlushDenormals flush;
    const Rendered flushed = render(kIterative, scene, settings);
    EXPECT_EQ(flushed.hash(), expected.hash());
    EXPECT_EQ(flushed.report.segments(), expected.report.segments());
}

}  // namespace
}  // namespace raypool
