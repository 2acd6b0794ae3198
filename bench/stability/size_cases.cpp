// Rows 10a and 10b: images of 65536 x 65536 pixels, and paths that split.

#include <algorithm>
#include <cmath>

#include "bench/naive/sizes.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/runtime/loop.h"
#include "wavefront/engine.h"

namespace raypool::stability {

namespace {

/// Pixels of a square image, its last among them, whose number is not their own.
template <class Number>
double wrong_pixels(double edge, std::int64_t pixels, Number number) {
    RandomInputs random(111);
    const auto width = static_cast<std::int64_t>(edge);
    std::int64_t wrong = 0;
    for (std::int64_t i = 0; i < pixels; ++i) {
        const std::int64_t x = i == 0 ? width - 1 : random.below(static_cast<int>(width));
        const std::int64_t y = i == 0 ? width - 1 : random.below(static_cast<int>(width));
        wrong += number(x, y, width) == y * width + x ? 0 : 1;
    }
    return share(wrong, pixels);
}
double wrong_int32(double edge, std::int64_t pixels) {
    return wrong_pixels(edge, pixels, naive::int32_pixel);
}
/// The engines' loop goes from the number to the pixel, and a path's key holds the number in 32 unsigned bits.
double wrong_ours(double edge, std::int64_t pixels) {
    return wrong_pixels(edge, pixels, [](std::int64_t x, std::int64_t y, std::int64_t width) -> std::int64_t {
        const std::int64_t item = y * width + x;
        const PixelRange range = WorkItems(width, width, {Grain::Kind::Pixel, 0}).range(item);
        const PathKey<float> key{static_cast<std::uint32_t>(range.y_begin * width + range.x_begin), 0};
        return std::int64_t{key.pixel};
    });
}

enum class Film : std::uint8_t { Joined, Ours };

/// Where in its pixel, the middle one of an image so wide, a camera ray goes through: the greatest error in pixels.
template <class Scalar, Film film>
double jitter_error(double width, std::int64_t samples) {
    CameraDescription description;
    description.vertical_fov_degrees = 2 * std::atan(0.5) * 180 / std::numbers::pi;  // one unit high at distance one
    const auto edge = static_cast<std::int64_t>(width);
    const Camera<Scalar> camera = make_camera<Scalar>(description, edge, edge);
    const RandomSeed seed = random_seed(0);
    const std::int64_t middle = edge / 2;
    const auto x = static_cast<Scalar>(middle);
    Errors errors;
    for (std::uint32_t sample = 0; sample < static_cast<std::uint32_t>(samples); ++sample) {
        const Scalar jitter = random_block<Scalar>({0, sample}, 0, RandomPurpose::Film, seed)[0];
        const Vec3<Scalar> d = film == Film::Ours
                                   ? camera_ray<Features{}, Scalar>(camera, x, x, 0, sample, seed).direction
                                   : naive::joined_column<Scalar>(camera, x, jitter);
        const double column = static_cast<double>(d[0]) / -static_cast<double>(d[2]) * width + 0.5 * width;
        errors.add(column - static_cast<double>(x) - static_cast<double>(jitter));
    }
    return errors.max();
}

constexpr std::int64_t kBatch = 1024;

/// Glass before glass: a camera that sees nothing but a stack of spheres.
CompiledScene<float> glass_stack() {
    Scene scene;
    scene.width = scene.height = 16;
    scene.background = {Vector3d::Ones(), Vector3d::Ones()};
    scene.textures.emplace_back();
    scene.materials.emplace_back();
    scene.materials[0].kind = Material::Kind::Dielectric;
    scene.materials[0].ior = 1.5;
    scene.camera.vertical_fov_degrees = 10;
    for (int i = 0; i < 4; ++i) {
        Sphere sphere;
        sphere.center0 = sphere.center1 = Vector3d(0, 0, -10.0 - 3 * i);
        scene.spheres.push_back(sphere);
    }
    return compile<float>(scene);
}

/// Most records in a round over the capacity of the pool.
double split_naive(double splits, std::int64_t) {
    return static_cast<double>(naive::breadth_first_records(kBatch, static_cast<int>(splits))) / kBatch;
}
double split_ours(double splits, std::int64_t) {
    static const CompiledScene<float> kScene = glass_stack();
    wavefront::PoolSettings pool;
    pool.capacity = kBatch;
    RenderSettings settings;
    settings.end_sample = 4;
    settings.split_depth = static_cast<int>(splits);
    settings.log_rounds = true;
    Framebuffer framebuffer(kScene.width, kScene.height, FixedPoint::make(4, kScene.max_radiance));
    const RenderReport report = wavefront::WavefrontEngine(pool).render(kScene, settings, framebuffer);
    std::int64_t most = 0;
    for (const RoundReport& round : report.rounds) most = std::max(most, std::max(round.records_in, round.records_out));
    return share(most, kBatch);
}

}  // namespace

std::vector<Case> size_cases() {
    std::vector<Case> cases;
    cases.push_back({.id = "large-image",
                     .row = "10a",
                     .parameter = "edge of a square image, pixels",
                     .values = {1024, 16'384, 46'340, 46'342, 65'536},
                     .measure = "pixels with a wrong number, share",
                     .tolerance = 0,
                     .symptom = "the lower part of the image overwrites the upper, or the program ends",
                     .samples = 20'000,
                     .methods = {{"int32", Kind::Naive, wrong_int32}, {"ours", Kind::Ours, wrong_ours}}});
    cases.push_back({.id = "pixel-jitter",
                     .row = "10a",
                     .parameter = "edge of a square image, pixels",
                     .values = {256, 1024, 4096, 16'384, 65'536},
                     .measure = "place in the middle pixel, greatest error, pixels",
                     .tolerance = 2e-4,
                     .symptom = "edges of large images are jagged again: 256 places in a pixel",
                     .samples = 10'000,
                     .methods = {{"pixel + jitter, float", Kind::Naive, jitter_error<float, Film::Joined>},
                                 {"ours, float", Kind::Ours, jitter_error<float, Film::Ours>},
                                 {"ours, double", Kind::Ours, jitter_error<double, Film::Ours>}}});
    cases.push_back(
        {.id = "splitting",
         .row = "10b",
         .parameter = "splits of a path",
         .values = {0, 1, 2, 3, 4, 5, 6, 7},
         .measure = "records alive at once over the pool's capacity",
         .tolerance = 1,
         .symptom = "memory runs out",
         .methods = {{"all branches at once", Kind::Naive, split_naive}, {"ours", Kind::Ours, split_ours}}});
    return cases;
}

}  // namespace raypool::stability
