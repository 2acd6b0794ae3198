/// The promises of advice: kept by fresh renders with other seeds. Costs are counted, not timed, so nothing here
/// depends on the machine.
#include "bench/accuracy/advise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "bench/accuracy/reference.h"
#include "core/base/error.h"
#include "tests/small_render.h"

namespace raypool::accuracy {
namespace {

constexpr double kSecondsPerSegment = 1e-6;

AdviseOptions counted() {
    AdviseOptions options;
    options.cost = [](const RenderReport& report) {
        return kSecondsPerSegment * static_cast<double>(report.segments());
    };
    return options;
}

struct Promise {
    const char* scene;
    std::vector<double> errors;
};

class AdvisePromise : public testing::TestWithParam<Promise> {};

TEST_P(AdvisePromise, IsKeptInNineOfTenFreshRunsAtThreeTargets) {
    const Scene description = small_scene(GetParam().scene, 32);
    const auto scene = std::make_shared<const SceneInBoth>(description);
    Reference reference(scene, 16384, {}, 2);
    for (const double error : GetParam().errors) {
        const Offer best = advise(description, {error, {}}, counted()).offers.front();
        int kept = 0;
        double mean_square = 0;
        for (std::uint64_t seed = 100; seed < 110; ++seed) {
            const Values image = render_image(best.pilot.configuration, *scene, {0, best.spp, seed, 2}).values;
            const double mse = corrected_mse(image, reference.halves());
            kept += mse <= error * error ? 1 : 0;
            mean_square += mse / 10;
        }
        const std::string text = to_string(best.pilot.configuration);
        EXPECT_GE(kept, 9) << text << ", " << best.spp << " spp for " << error;
        // Sobol points come in powers of two, so up to twice as many as are needed.
        const double least = best.pilot.configuration.sampler == Sampler::Sobol ? 0.5 / std::sqrt(2) : 0.5;
        EXPECT_GT(std::sqrt(mean_square), least * error) << "and not by waste: " << text << ", " << best.spp << " spp";
        EXPECT_GE(std::sqrt(mean_square), 0.9 * best.error_interval.low) << text;
        EXPECT_LE(std::sqrt(mean_square), 1.1 * best.error_interval.high) << text;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, AdvisePromise,
                         testing::Values(Promise{"paper", {0.05, 0.02, 0.01}},
                                         Promise{"glass_stack", {0.05, 0.02, 0.01}},
                                         Promise{"half_sky", {0.02, 0.01, 0.005}}),
                         [](const auto& info) { return info.param.scene; });

TEST(Advise, WithABudgetPlansNoMoreThanItAndPromisesLessErrorForMore) {
    const Scene scene = small_scene("paper", 32);
    double before = 1e9;
    for (const double seconds : {0.02, 0.2, 2.0}) {
        const Offer best = advise(scene, {{}, seconds}, counted()).offers.front();
        EXPECT_LE(best.seconds, seconds);
        EXPECT_GT(best.seconds, 0.5 * seconds) << "and uses it";
        EXPECT_LT(best.error, before);
        before = best.error;
    }
}

TEST(Advise, TakesNoDepthWhoseBiasIsBeyondTheTarget) {
    const Advice advice = advise(small_scene("glass_stack", 32), {0.01, {}}, counted());
    for (const Offer& offer : advice.offers) {
        EXPECT_GT(offer.pilot.configuration.depth, 5);
        EXPECT_LT(offer.pilot.bias.value, 0.01 * 0.01);
    }
    for (const Simplification& s : advice.simplifications) {
        if (s.text.starts_with("depth 5 ")) {
            EXPECT_GT(std::sqrt(s.bias.value), 0.1);
        }
        if (s.text.starts_with("float")) {
            EXPECT_LT(std::sqrt(std::max(s.bias.value, 0.0)), 1e-3);
        }
    }
}

TEST(Advise, TriesSplittingOnlyWhereThereIsGlass) {
    const auto tries_splitting = [](const char* scene) {
        for (const Simplification& s : advise(small_scene(scene, 16), {0.1, {}}, counted()).simplifications)
            if (s.text.find("glass") != std::string::npos) return true;
        return false;
    };
    EXPECT_TRUE(tries_splitting("glass_stack"));
    EXPECT_FALSE(tries_splitting("one_sphere"));
}

TEST(Advise, TriesLightSamplingOnlyWhereThereAreLights) {
    const auto advice = [](const char* scene) { return advise(small_scene(scene, 16), {0.3, {}}, counted()); };
    const auto tries = [](const Advice& given) {
        return std::any_of(given.simplifications.begin(), given.simplifications.end(),
                           [](const Simplification& s) { return s.text.starts_with("lights sampled"); });
    };
    const Advice with = advice("cornell");
    const Advice without = advice("one_sphere");
    EXPECT_TRUE(tries(with));
    EXPECT_FALSE(tries(without));
    const auto flags = [](const Advice& given) {
        return render_flags(given.offers.front().pilot.configuration, given.features);
    };
    EXPECT_NE(flags(with).find("--light-sampling"), std::string::npos) << "the command's default is another";
    EXPECT_EQ(flags(without).find("--light-sampling"), std::string::npos);
}

/// A closed grey room whose ceiling lamp has edges of `edge` times the room's, and always the same power.
Scene room(double edge) {
    Scene scene;
    scene.width = scene.height = 16;
    scene.camera.look_from = {0.5, 0.45, 0.02};
    scene.camera.look_at = {0.5, 0.4, 1};
    scene.camera.vertical_fov_degrees = 75;
    scene.background.bottom = scene.background.top = Vector3d(0, 0, 0);
    scene.textures.resize(2);
    scene.textures[0].even = Vector3d(0.5, 0.5, 0.5);
    scene.textures[1].even = Vector3d(0.9, 0.9, 0.9) / (edge * edge);
    scene.materials.resize(2);
    scene.materials[1].kind = Material::Kind::Emissive;
    scene.materials[1].texture_id = 1;
    const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), origin(0, 0, 0);
    for (const auto& [corner, u, v] :
         {std::array{origin, x, y}, {origin, y, z}, {origin, z, x}, {x, y, z}, {y, z, x}, {z, x, y}})
        scene.quads.push_back({corner, u, v, 0});
    const double middle = 0.5 - 0.5 * edge;
    scene.quads.push_back({{middle, 1 - 0.01 * edge, middle}, edge * x, edge * z, 1});
    return scene;
}

AdviseOptions counted_dearly() {
    AdviseOptions options;
    options.cost = [](const RenderReport& report) { return 1e-5 * static_cast<double>(report.segments()); };
    return options;
}

TEST(Advise, PromisesNothingWhereItsTrialsFoundTooLittleLight) {
    for (const double edge : {0.01, 0.003, 0.001}) {
        EXPECT_THROW(advise(room(edge), {0.1, {}}, counted_dearly()), NothingPromised) << edge;
        EXPECT_THROW(advise(room(edge), {{}, 10.0}, counted_dearly()), NothingPromised) << edge;
    }
}

TEST(Advise, KeepsItsPromiseInARoomWithASmallLamp) {
    constexpr double kTarget = 0.2;
    const Scene description = room(0.1);
    const SceneInBoth scene(description);
    Configuration exact;
    exact.depth = 100;
    exact.light_sampling = LightSampling::Mis;
    const Values truth = render_image(exact, scene, {0, 2048, 77, 2}).values;
    const Offer best = advise(description, {kTarget, {}}, counted()).offers.front();
    int kept = 0;
    for (std::uint64_t seed = 100; seed < 116; ++seed) {
        const Values image = render_image(best.pilot.configuration, scene, {0, best.spp, seed, 2}).values;
        kept += mean_squared_difference(image, truth) <= kTarget * kTarget ? 1 : 0;
    }
    EXPECT_GE(kept, 15) << to_string(best.pilot.configuration) << ", " << best.spp << " spp";
}

TEST(Advise, ChargesADepthWithTheLightThatNoTrialSawItCutOff) {
    const Advice advice = advise(room(0.1), {0.2, {}}, counted());
    double before = std::numeric_limits<double>::infinity();
    for (const Simplification& s : advice.simplifications) {
        if (!s.text.starts_with("depth ")) continue;
        EXPECT_GT(s.unseen_bias, 0) << s.text;
        EXPECT_LE(s.unseen_bias, before * (1 + 1e-9)) << s.text;
        before = s.unseen_bias;
    }
}

TEST(Advise, RefusesWhatNoNumberOfSamplesReaches) {
    const Scene scene = small_scene("paper", 16);
    EXPECT_THROW(advise(scene, {1e-9, {}}, counted()), InputError);
    EXPECT_THROW(advise(scene, {{}, 1e-6}, counted()), InputError);
}

struct SamplesCase {
    const char* what;
    double slope;
    Estimate bias;
    double error;
    std::int64_t samples;  ///< 0: none
};
class SamplesFor : public testing::TestWithParam<SamplesCase> {};

TEST_P(SamplesFor, AreWhatTheNoiseLeftBesideTheBiasAsksFor) {
    const SamplesCase& c = GetParam();
    const Pilot pilot{{}, 16, std::vector<double>(8, 0.01), std::vector<double>(8, 1), c.slope, c.bias};
    const auto samples = samples_for(pilot, {c.error, {}});
    EXPECT_EQ(samples.value_or(0), c.samples) << c.what;
    if (samples) {
        EXPECT_LE(pilot.most_error(static_cast<double>(*samples)), c.error * (1 + 1e-12));
    }
}
INSTANTIATE_TEST_SUITE_P(Cases, SamplesFor,
                         testing::Values(SamplesCase{"the pilot's own error", -1, {}, 0.1, 16},
                                         SamplesCase{"half of it", -1, {}, 0.05, 64},
                                         SamplesCase{"a steeper slope", -1.25, {}, 0.1 / 31.999, 16 * 256},
                                         SamplesCase{"a bias of most of it", -1, {0.0075, 0}, 0.1, 64},
                                         SamplesCase{"a bias that may be", -1, {0, 0.00375}, 0.1, 64},
                                         SamplesCase{"a bias beyond it", -1, {0.0101, 0}, 0.1, 0},
                                         SamplesCase{"far more than it needs", -1, {}, 10, 1},
                                         SamplesCase{"too many", -1, {}, 1e-9, 0}),
                         [](const auto& info) { return std::to_string(info.index); });

}  // namespace
}  // namespace raypool::accuracy
