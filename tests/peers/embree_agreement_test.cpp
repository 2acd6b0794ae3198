// The peer (bench/peers/) and the engines share no equation. That their images agree within noise is a check of both.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "bench/peers/embree_path_tracer.h"
#include "tests/peers/welch.h"
#include "tests/significance.h"
#include "tests/small_render.h"

namespace raypool {
namespace {

constexpr int kBatches = 16;  // renders with different seeds; the spread between them is the measure of noise
constexpr std::int64_t kBatchSpp = 16;
constexpr std::int32_t kDepth = 50;
constexpr int kGrid = 5;  // tiles across and down
constexpr int kFigures = 3 * kGrid * kGrid + 1;
constexpr int kTests = 10 * kFigures;  // five scenes, two modes

/// What is compared of a render: the mean of each channel over each tile, and the segments of a path.
using Figures = std::array<double, kFigures>;

Figures figures(const Image& image, double segments_per_path) {
    Figures out{};
    std::array<double, kGrid * kGrid> count{};
    for (std::int64_t y = 0; y < image.height; ++y) {
        for (std::int64_t x = 0; x < image.width; ++x) {
            const auto tile = static_cast<std::size_t>(y * kGrid / image.height * kGrid + x * kGrid / image.width);
            count[tile] += 1;
            for (std::size_t k = 0; k < 3; ++k) out[3 * tile + k] += image.pixel(x, y)[k];
        }
    }
    for (std::size_t i = 0; i + 1 < kFigures; ++i) out[i] /= count[i / 3];
    out[kFigures - 1] = segments_per_path;
    return out;
}

std::vector<Figures> by_engine(const Scene& scene) {
    const CompiledScene<float> compiled = compile<float>(scene);
    std::vector<Figures> batches;
    for (int batch = 0; batch < kBatches; ++batch) {
        RenderSettings settings;
        settings.end_sample = kBatchSpp;
        settings.depth = kDepth;
        settings.seed = static_cast<std::uint64_t>(batch);
        const Rendered rendered = render(recursive::RecursiveEngine(), compiled, settings);
        batches.push_back(figures(rendered.image(), static_cast<double>(rendered.report.segments()) /
                                                        static_cast<double>(rendered.report.paths())));
    }
    return batches;
}

std::vector<Figures> by_peer(const Scene& scene, peers::PeerMode mode) {
    std::vector<Figures> batches;
    for (int batch = 0; batch < kBatches; ++batch) {
        Image image;
        const peers::PeerReport report = peers::render_embree(
            scene, {.spp = kBatchSpp, .depth = kDepth, .seed = static_cast<std::uint64_t>(batch), .mode = mode}, image);
        batches.push_back(figures(image, static_cast<double>(report.segments) / static_cast<double>(report.paths)));
    }
    return batches;
}

/// Fails with the figures that differ by more than chance.
testing::AssertionResult agree(const std::vector<Figures>& engine, const std::vector<Figures>& peer) {
    testing::AssertionResult result = testing::AssertionSuccess();
    for (std::size_t i = 0; i < kFigures; ++i) {
        std::vector<double> a;
        std::vector<double> b;
        for (int batch = 0; batch < kBatches; ++batch) {
            a.push_back(engine[static_cast<std::size_t>(batch)][i]);
            b.push_back(peer[static_cast<std::size_t>(batch)][i]);
        }
        const test::MeanEstimate of_engine(a);
        const test::MeanEstimate of_peer(b);
        const double p = test::p_value_of_welch(of_engine, of_peer, 1e-6 * std::abs(of_engine.mean));
        if (!test::is_significant(p, kTests)) continue;
        if (result) result = testing::AssertionFailure();
        const std::string what = i + 1 == kFigures
                                     ? "segments a path"
                                     : "channel " + std::to_string(i % 3) + " of tile " +
                                           std::to_string(i / 3 % kGrid) + ", " + std::to_string(i / 3 / kGrid);
        result << what << ": engine " << of_engine.mean << " +- " << std::sqrt(of_engine.variance) << ", peer "
               << of_peer.mean << " +- " << std::sqrt(of_peer.variance) << ", p = " << p << "\n";
    }
    return result;
}

struct Case {
    const char* scene;
    int width;
};

class EmbreePeer : public testing::TestWithParam<Case> {};

TEST_P(EmbreePeer, MakesTheImageOfTheEngineWithinNoise) {
    const Scene scene = small_scene(GetParam().scene, GetParam().width);
    const std::vector<Figures> engine = by_engine(scene);
    EXPECT_TRUE(agree(engine, by_peer(scene, peers::PeerMode::Single)));
    EXPECT_TRUE(agree(engine, by_peer(scene, peers::PeerMode::Packet)));
}

INSTANTIATE_TEST_SUITE_P(Scenes, EmbreePeer,
                         testing::Values(Case{"paper", 80}, Case{"cornell", 50}, Case{"glass_stack", 60},
                                         Case{"textures", 60}, Case{"furnace", 40}),
                         [](const auto& info) { return info.param.scene; });

TEST(EmbreePeerComparison, NoticesGlassThatIsALittleTooDense) {
    Scene scene = small_scene("glass_stack", 60);
    const std::vector<Figures> engine = by_engine(scene);
    for (Material& material : scene.materials)
        if (material.ior > 1) material.ior = 1.53;
    EXPECT_FALSE(agree(engine, by_peer(scene, peers::PeerMode::Packet)));
}

TEST(EmbreePeerComparison, NoticesCheckersThatAreAThirdLarger) {
    Scene scene = small_scene("textures", 60);
    const std::vector<Figures> engine = by_engine(scene);
    for (Texture& texture : scene.textures) texture.scale *= 4 / 3.0;
    EXPECT_FALSE(agree(engine, by_peer(scene, peers::PeerMode::Packet)));
}

TEST(EmbreePeerImage, DoesNotDependOnTheNumberOfThreads) {
    const Scene scene = small_scene("paper", 40);
    for (const peers::PeerMode mode : {peers::PeerMode::Single, peers::PeerMode::Packet}) {
        Image one;
        Image three;
        peers::render_embree(scene, {.spp = 4, .threads = 1, .mode = mode}, one);
        peers::render_embree(scene, {.spp = 4, .threads = 3, .mode = mode}, three);
        EXPECT_EQ(one.rgb, three.rgb);
    }
}

TEST(WelchTest, KnowsStudentsDistribution) {
    EXPECT_NEAR(test::p_value_of_t(1, 1), 0.5, 1e-9);
    EXPECT_NEAR(test::p_value_of_t(2.0860, 20), 0.05, 1e-5);
    EXPECT_NEAR(test::p_value_of_t(4.0728, 15) / 0.001, 1, 1e-3);
}

}  // namespace
}  // namespace raypool
