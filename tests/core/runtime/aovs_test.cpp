/// AOVs against what geometry and a white sky say of them, and variance against that of many renders.
#include "core/runtime/aovs.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/film/half_variance.h"
#include "core/scene/scene_parser.h"
#include "tests/significance.h"
#include "tests/small_render.h"

namespace raypool::test {
namespace {

using Channels = std::map<std::string, std::vector<float>>;

Channels by_name(const std::vector<ImageChannel>& channels) {
    Channels named;
    for (const ImageChannel& channel : channels) named[channel.name] = channel.values;
    return named;
}

template <class Scalar = float>
Channels first_hits(const Scene& scene, const ImageSamples& samples, int threads = 1,
                    const ImageSettings& settings = {}) {
    return by_name(first_hit_channels(compile<Scalar>(scene), settings, samples, threads));
}

ImageSamples all_of(const Scene& scene, std::int64_t spp) {
    return {{0, scene.width, 0, scene.height}, 0, spp};
}

/// Shapes between a camera at (0, 0, 5), which looks at the origin, and a white sky.
Scene white_room(const std::string& shapes) {
    return parse_scene(fmt::format(R"({{
        "description": "A white sky.",
        "image": {{"width": 24, "height": 16}},
        "camera": {{"look_from": [0, 0, 5], "look_at": [0, 0, 0], "vertical_fov_degrees": 40}},
        "background": [1, 1, 1],
        "textures": {{"tiles": {{"type": "checker_uv", "even": [0.1, 0.2, 0.3], "odd": [0.9, 0.8, 0.7], "scale": 0.1}},
                      "bright": {{"type": "solid", "color": [3, 3, 3]}}}},
        "materials": {{"tiled": {{"type": "diffuse", "albedo": "tiles"}},
                       "metal": {{"type": "metal", "albedo": "tiles", "fuzz": 0}},
                       "glass": {{"type": "dielectric", "ior": 1.5}},
                       "lamp": {{"type": "emissive", "radiance": "bright"}}}},
        "shapes": [{}]}})",
                                   shapes),
                       "white_room.json", ".");
}

/// A convex body in a white sky shows its albedo: what it scatters arrives at the sky. That tells that first hits are
/// of the render's own camera rays, by their lens, time, seed and sampler.
TEST(Aovs, AlbedoIsWhatAWhiteSkyShows) {
    RenderSettings settings;
    settings.end_sample = 8;
    settings.depth = 2;
    for (const bool is_blurred : {false, true}) {
        for (const char* const material : {"tiled", "metal"}) {
            Scene scene = white_room(
                fmt::format(R"({{"type": "sphere", "center": [0.3, 0, 0], "radius": 1, "material": "{}"}})", material));
            if (is_blurred) {
                scene.camera.defocus_angle_degrees = 4;
                scene.camera.focus_distance = 3;
                scene.camera.shutter_close = 1;
                scene.spheres[0].center1 += Vector3d(0.5, 0.2, 0);
                settings.seed = 7;
                settings.sampler = Sampler::Sobol;
            }
            const Image image = raypool::render(recursive::IterativeEngine(), compile<float>(scene), settings).image();
            Channels aovs = first_hits(scene, all_of(scene, settings.end_sample), 2, settings);
            int partly = 0;
            for (std::size_t i = 0; i < image.rgb.size() / 3; ++i) {
                const float alpha = aovs["A"][i];
                partly += alpha > 0 && alpha < 1 ? 1 : 0;
                EXPECT_NEAR(image.rgb[3 * i], 1 - alpha + aovs["albedo.R"][i], 2e-6) << i;
                EXPECT_NEAR(image.rgb[3 * i + 1], 1 - alpha + aovs["albedo.G"][i], 2e-6) << i;
                EXPECT_NEAR(image.rgb[3 * i + 2], 1 - alpha + aovs["albedo.B"][i], 2e-6) << i;
            }
            EXPECT_GT(partly, is_blurred ? 40 : 10);
        }
    }
}

TEST(Aovs, AlbedoOfGlassIsOneAndOfALampZero) {
    for (const auto& [material, albedo] : {std::pair{"glass", 1.F}, {"lamp", 0.F}}) {
        const Scene scene = white_room(
            fmt::format(R"({{"type": "sphere", "center": [0, 0, 5], "radius": 2, "material": "{}"}})", material));
        Channels aovs = first_hits(scene, all_of(scene, 2));
        for (std::size_t i = 0; i < aovs["A"].size(); ++i) {
            EXPECT_EQ(aovs["A"][i], 1);
            EXPECT_EQ(aovs["albedo.G"][i], albedo);
            EXPECT_NEAR(aovs["Z"][i], 2, 1e-6);  // the camera is in its centre
        }
    }
}

/// Of one sample a pixel: the normal leads from the centre to a point that is as far away as the depth says.
template <class Scalar>
void expect_sphere(double tolerance) {
    const Scene scene = white_room(R"({"type": "sphere", "center": [0.3, 0.1, 0], "radius": 1, "material": "tiled"})");
    Channels aovs = first_hits<Scalar>(scene, all_of(scene, 1));
    int hits = 0;
    for (std::size_t i = 0; i < aovs["A"].size(); ++i) {
        const Vec3<double> normal = vec3<double>(aovs["N.X"][i], aovs["N.Y"][i], aovs["N.Z"][i]);
        if (aovs["A"][i] == 0) {
            EXPECT_EQ(normal.norm(), 0);
            EXPECT_EQ(aovs["Z"][i], std::numeric_limits<float>::infinity());
            continue;
        }
        ++hits;
        const Vec3<double> point = vec3<double>(0.3, 0.1, 0) + normal;
        const Vec3<double> to_camera = vec3<double>(0, 0, 5) - point;
        EXPECT_NEAR(normal.norm(), 1, tolerance);
        EXPECT_NEAR(to_camera.norm(), aovs["Z"][i], 5 * tolerance);
        EXPECT_GT(to_camera.dot(normal), 0);
    }
    EXPECT_GT(hits, 50);
    EXPECT_LT(hits, 200);
}
TEST(Aovs, DepthAndNormalAgreeOnASphere) {
    expect_sphere<float>(1e-6);
    expect_sphere<double>(2e-7);  // they are written as floats
}

TEST(Aovs, NormalIsThatOfShadingAndFacesTheCamera) {
    Scene scene = white_room(
        R"({"type": "quad", "corner": [-9, -9, 1], "edge_u": [0, 18, 0], "edge_v": [18, 0, 0], "material": "tiled"})");
    Channels quad = first_hits(scene, all_of(scene, 3));  // its own normal is (0, 0, -1)
    for (std::size_t i = 0; i < quad["N.Z"].size(); ++i) {
        EXPECT_EQ(quad["N.Z"][i], 1);
        EXPECT_GE(quad["Z"][i], 4);
        EXPECT_LT(quad["Z"][i], 5);
    }
    // A smooth mesh has normals between those of its faces, an instance those of its own place.
    for (const char* const name : {"smooth", "instances"}) {
        scene = small_scene(name, 60);
        Channels aovs = first_hits(scene, all_of(scene, 1));
        std::map<std::array<float, 3>, int> seen;
        for (std::size_t i = 0; i < aovs["A"].size(); ++i) {
            if (aovs["A"][i] == 0) continue;
            const std::array<float, 3> normal{aovs["N.X"][i], aovs["N.Y"][i], aovs["N.Z"][i]};
            EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1, 1e-5) << name;
            ++seen[normal];
        }
        EXPECT_GT(seen.size(), 20) << name;
    }
}

TEST(Aovs, OfAPartAreThoseOfTheWholeWithAnyThreads) {
    const Scene scene = small_scene("cornell", 20);
    const std::int64_t width = scene.width;
    Channels whole = first_hits(scene, {{0, width, 0, scene.height}, 3, 6});
    const Channels part = first_hits(scene, {{5, 12, 7, 11}, 3, 6}, 3);
    for (const auto& [name, values] : part) {
        ASSERT_EQ(values.size(), 7 * 4);
        for (std::size_t y = 0; y < 4; ++y)
            for (std::size_t x = 0; x < 7; ++x)
                EXPECT_EQ(values[7 * y + x], whole[name][(7 + y) * static_cast<std::size_t>(width) + 5 + x]) << name;
    }
    EXPECT_NE(whole, first_hits(scene, {{0, width, 0, scene.height}, 0, 3}));
    const std::vector<std::int32_t> counts(static_cast<std::size_t>(width * scene.height), 6);
    EXPECT_EQ(first_hits(scene, {{0, width, 0, scene.height}, 3, 5, counts}),
              first_hits(scene, {{0, width, 0, scene.height}, 0, 6}));
}

TEST(HalfCounts, AreThoseOfTheSamplesOneByOne) {
    for (const std::size_t pixel : {0U, 1U, 77U, 4095U})
        for (std::int64_t first = 0; first < 9; ++first)
            for (std::int64_t end = first; end < 20; ++end) {
                std::int64_t count[2] = {0, 0};
                for (std::int64_t s = first; s < end; ++s)
                    ++count[half_of_sample(static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(s))];
                const HalfCounts counts = HalfCounts::of(pixel, first, end);
                EXPECT_EQ(counts.a, count[0]);
                EXPECT_EQ(counts.b, count[1]);
            }
}

struct VarianceCheck {
    double difference = 0;  ///< of the estimates from the squared deviations of pixels from their mean, over many seeds
    double error = 0;       ///< standard error of that
    double truth = 0;
};
VarianceCheck check_variance(Sampler sampler) {
    const Scene scene = small_scene("cornell", 6);
    const CompiledScene<float> compiled = compile<float>(scene);
    const ImageSamples samples{{0, scene.width, 0, scene.height}, 2, 7};
    constexpr int kSeeds = 600;
    std::vector<Image> images;
    std::vector<double> estimates;  // sums over an image
    for (int seed = 0; seed < kSeeds; ++seed) {
        RenderSettings settings;
        settings.first_sample = samples.first;
        settings.end_sample = samples.end;
        settings.seed = static_cast<std::uint64_t>(seed);
        settings.depth = 5;
        settings.sampler = sampler;
        Framebuffer framebuffer(scene.width, scene.height, fixed_point(compiled, settings, 7), Halves::Apart);
        recursive::IterativeEngine().render(compiled, settings, framebuffer);
        Channels aovs = by_name(variance_channels(framebuffer, samples));
        EXPECT_EQ(aovs["samples"][0], 5);
        double sum = 0;
        for (const char* const name : {"variance.R", "variance.G", "variance.B"})
            for (const float value : aovs[name]) sum += static_cast<double>(value);
        estimates.push_back(sum);
        images.push_back(framebuffer.together().image(5));
    }
    const std::size_t values = images[0].rgb.size();
    std::vector<double> mean(values);
    for (const Image& image : images)
        for (std::size_t i = 0; i < values; ++i) mean[i] += static_cast<double>(image.rgb[i]) / kSeeds;
    double difference = 0;
    double squares = 0;
    double true_variance = 0;
    for (std::size_t seed = 0; seed < kSeeds; ++seed) {
        double deviation = 0;
        for (std::size_t i = 0; i < values; ++i)
            deviation += std::pow(static_cast<double>(images[seed].rgb[i]) - mean[i], 2) * kSeeds / (kSeeds - 1);
        true_variance += deviation / kSeeds;
        difference += (estimates[seed] - deviation) / kSeeds;
        squares += std::pow(estimates[seed] - deviation, 2) / kSeeds;
    }
    return {difference, std::sqrt(squares / kSeeds), true_variance};
}

TEST(Aovs, VarianceIsThatOfManyRenders) {
    const VarianceCheck check = check_variance(Sampler::Independent);
    EXPECT_LT(check.error, 0.1 * check.truth);  // so that it can fail
    EXPECT_FALSE(is_significant(p_value_of_z(check.difference / check.error), 1)) << check.difference;
}
TEST(Aovs, VarianceIsTooHighOfSamplesThatAvoidEachOther) {
    const VarianceCheck check = check_variance(Sampler::Sobol);
    EXPECT_GT(check.difference, 0.2 * check.truth);
    EXPECT_LT(check.difference, 10 * check.truth);
}

TEST(Aovs, VarianceOfOneSampleIsNotKnown) {
    const Scene scene = small_scene("cornell", 4);
    const Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(1, 1), Halves::Apart);
    EXPECT_EQ(by_name(variance_channels(framebuffer, all_of(scene, 1)))["variance.G"][3],
              std::numeric_limits<float>::infinity());
    EXPECT_EQ(by_name(variance_channels(framebuffer, all_of(scene, 2)))["variance.G"][3], 0);
}

}  // namespace
}  // namespace raypool::test
