// The brute-force tracer and the engines share no equation. That their images agree within noise is a check of both.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/reference/brute_force_tracer.h"
#include "tests/reference/welch.h"
#include "tests/significance.h"
#include "tests/small_render.h"
#include "wavefront/engine.h"

namespace raypool {
namespace {

constexpr int kBatches = 16;  // renders with different seeds; the spread between them is the measure of noise
constexpr int kBatchSpp = 16;
constexpr std::int32_t kDepth = 50;
constexpr int kGrid = 5;  // tiles across and down
constexpr int kFigures = 3 * kGrid * kGrid + 1;
constexpr int kTests = 16 * kFigures;  // eight scenes, two precisions

/// What is compared of a render: the mean of each channel over each tile, and the segments of a path.
using Figures = std::array<double, kFigures>;

/// `rgb` is three numbers a pixel, line by line.
Figures figures(const Scene& scene, const auto& rgb, double segments_per_path) {
    Figures out{};
    std::array<double, kGrid * kGrid> count{};
    auto channel = rgb.begin();
    for (std::int64_t y = 0; y < scene.height; ++y) {
        for (std::int64_t x = 0; x < scene.width; ++x) {
            const auto tile = static_cast<std::size_t>(y * kGrid / scene.height * kGrid + x * kGrid / scene.width);
            count[tile] += 1;
            for (std::size_t k = 0; k < 3; ++k) out[3 * tile + k] += *channel++;
        }
    }
    for (std::size_t i = 0; i + 1 < kFigures; ++i) out[i] /= count[i / 3];
    out[kFigures - 1] = segments_per_path;
    return out;
}

template <class Scalar>
std::vector<Figures> by_engine(const Engine& engine, const Scene& scene) {
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    std::vector<Figures> batches;
    for (int batch = 0; batch < kBatches; ++batch) {
        RenderSettings settings;
        settings.end_sample = kBatchSpp;
        settings.depth = kDepth;
        settings.seed = static_cast<std::uint64_t>(batch);
        const Rendered rendered = render(engine, compiled, settings);
        batches.push_back(
            figures(scene, rendered.image().rgb,
                    static_cast<double>(rendered.report.segments()) / static_cast<double>(rendered.report.paths())));
    }
    return batches;
}

std::vector<Figures> by_brute_force(const Scene& scene) {
    std::vector<Figures> batches;
    for (int batch = 0; batch < kBatches; ++batch) {
        const test::BruteForceRender rendered =
            test::brute_force_render(scene, kBatchSpp, kDepth, static_cast<std::uint64_t>(batch));
        batches.push_back(figures(scene, rendered.rgb, rendered.segments_per_path));
    }
    return batches;
}

/// Fails with the figures that differ by more than chance.
testing::AssertionResult agree(const std::vector<Figures>& engine, const std::vector<Figures>& reference) {
    testing::AssertionResult result = testing::AssertionSuccess();
    for (std::size_t i = 0; i < kFigures; ++i) {
        std::vector<double> a;
        std::vector<double> b;
        for (int batch = 0; batch < kBatches; ++batch) {
            a.push_back(engine[static_cast<std::size_t>(batch)][i]);
            b.push_back(reference[static_cast<std::size_t>(batch)][i]);
        }
        const test::MeanEstimate of_engine(a);
        const test::MeanEstimate of_reference(b);
        const double p = test::p_value_of_welch(of_engine, of_reference, 1e-6 * std::abs(of_engine.mean));
        if (!test::is_significant(p, kTests)) continue;
        if (result) result = testing::AssertionFailure();
        const std::string what = i + 1 == kFigures
                                     ? "segments a path"
                                     : "channel " + std::to_string(i % 3) + " of tile " +
                                           std::to_string(i / 3 % kGrid) + ", " + std::to_string(i / 3 / kGrid);
        result << what << ": engine " << of_engine.mean << " +- " << std::sqrt(of_engine.variance) << ", brute force "
               << of_reference.mean << " +- " << std::sqrt(of_reference.variance) << ", p = " << p << "\n";
    }
    return result;
}

struct Case {
    const char* scene;
    int width;
};

class BruteForceAgreement : public testing::TestWithParam<Case> {};

TEST_P(BruteForceAgreement, OfTheImageOfEachPrecisionWithinNoise) {
    const Scene scene = small_scene(GetParam().scene, GetParam().width);
    const std::vector<Figures> reference = by_brute_force(scene);
    EXPECT_TRUE(agree(by_engine<float>(recursive::RecursiveEngine(), scene), reference));
    EXPECT_TRUE(agree(by_engine<double>(wavefront::WavefrontEngine({}), scene), reference));
}

INSTANTIATE_TEST_SUITE_P(Scenes, BruteForceAgreement,
                         testing::Values(Case{"paper", 80}, Case{"cornell", 50}, Case{"glass_stack", 60},
                                         Case{"textures", 60}, Case{"furnace", 40}, Case{"sky_image", 50},
                                         Case{"solids", 60}, Case{"smooth", 60}, Case{"instances", 50}),
                         [](const auto& info) { return info.param.scene; });

TEST(BruteForceComparison, NoticesGlassThatIsALittleTooDense) {
    Scene scene = small_scene("glass_stack", 60);
    const std::vector<Figures> engine = by_engine<float>(recursive::RecursiveEngine(), scene);
    for (Material& material : scene.materials)
        if (material.ior > 1) material.ior = 1.53;
    EXPECT_FALSE(agree(engine, by_brute_force(scene)));
}

TEST(BruteForceComparison, NoticesCheckersThatAreAThirdLarger) {
    Scene scene = small_scene("textures", 60);
    const std::vector<Figures> engine = by_engine<float>(recursive::RecursiveEngine(), scene);
    for (Texture& texture : scene.textures) texture.scale *= 4 / 3.0;
    EXPECT_FALSE(agree(engine, by_brute_force(scene)));
}

TEST(WelchTest, KnowsStudentsDistribution) {
    EXPECT_NEAR(test::p_value_of_t(1, 1), 0.5, 1e-9);
    EXPECT_NEAR(test::p_value_of_t(2.0860, 20), 0.05, 1e-5);
    EXPECT_NEAR(test::p_value_of_t(4.0728, 15) / 0.001, 1, 1e-3);
}

}  // namespace
}  // namespace raypool
