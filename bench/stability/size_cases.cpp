// Rows 10a and 10b: images of 65536 x 65536 pixels, and paths that split.

#include <algorithm>
#include <cmath>

#include "bench/stability/case.h"
#include "bench/stability/methods.h"
#include "core/runtime/loop.h"
#include "core/shading/camera.h"
#include "wavefront/engine.h"

namespace raypool::stability {

namespace {

// Ways to number the pixels of an image.
/// y * width + x in 32 bits; what overflows wraps around.
std::int64_t int32_pixel(std::int64_t x, std::int64_t y, std::int64_t width) {
    const auto product = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width);
    return static_cast<std::int32_t>(product + static_cast<std::uint32_t>(x));
}
/// The engines' loop goes from the number to the pixel, and a path's key holds the number in 32 unsigned bits.
std::int64_t our_pixel(std::int64_t x, std::int64_t y, std::int64_t width) {
    const PixelRange range = WorkItems(width, width, {Grain::Kind::Pixel, 0}).range(y * width + x);
    return PathKey<float>{static_cast<std::uint32_t>(range.y_begin * width + range.x_begin), 0}.pixel;
}
/// Pixels of a square image, its last among them, whose number is not their own.
constexpr auto kWrongPixels = []<class>(const auto& number, double edge, std::int64_t pixels) {
    const auto width = static_cast<std::int64_t>(edge);
    bool is_first = true;
    return share_of(pixels, RandomInputs(111), [&](RandomInputs& random) {
        const bool is_last = std::exchange(is_first, false);
        const std::int64_t x = is_last ? width - 1 : random.below(static_cast<int>(width));
        const std::int64_t y = is_last ? width - 1 : random.below(static_cast<int>(width));
        return number(x, y, width) != y * width + x;
    });
};

// Ways to find the direction of a camera ray through a pixel of the middle line.
/// Column and jitter are added before anything else.
constexpr auto kJoined = []<class Scalar>(const Camera<Scalar>& camera, Scalar x, std::uint32_t, Scalar jitter) {
    const Scalar column = (x + jitter) - camera.half_width;
    return unit<Scalar>(Vec3<Scalar>(camera.to_center + column * camera.pixel_u));
};
constexpr auto kOurs = []<class Scalar>(const Camera<Scalar>& camera, Scalar x, std::uint32_t sample, Scalar) {
    return camera_ray<Features{}, Scalar>(camera, x, x, 0, sample, random_seed(0)).direction;
};
/// Where in its pixel, the middle one of an image so wide, a camera ray goes through: the greatest error in pixels.
constexpr auto kJitterError = []<class Scalar>(const auto& ray_direction, double width, std::int64_t samples) {
    CameraDescription description;
    description.vertical_fov_degrees = 2 * std::atan(0.5) * 180 / std::numbers::pi;  // one unit high at distance one
    const auto edge = static_cast<std::int64_t>(width);
    const Camera<Scalar> camera = make_camera<Scalar>(description, edge, edge);
    const std::int64_t middle = edge / 2;
    const auto x = static_cast<Scalar>(middle);
    Errors errors;
    for (std::uint32_t sample = 0; sample < static_cast<std::uint32_t>(samples); ++sample) {
        const Scalar jitter = random_block<Scalar>({0, sample}, 0, RandomPurpose::Film, random_seed(0))[0];
        const Vec3<Scalar> d = ray_direction(camera, x, sample, jitter);
        const double column = static_cast<double>(d[0]) / -static_cast<double>(d[2]) * width + 0.5 * width;
        errors.add(column - static_cast<double>(x) - static_cast<double>(jitter));
    }
    return errors.max();
};

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

// Ways to split paths: most records in a round over the capacity of the pool.
/// Every record of a batch is split so often before any of them ends.
double all_at_once(int splits) {
    return share(kBatch << splits, kBatch);
}
double in_our_pool(int splits) {
    static const CompiledScene<float> kScene = glass_stack();
    wavefront::PoolSettings pool;
    pool.capacity = kBatch;
    RenderSettings settings;
    settings.end_sample = 4;
    settings.split_depth = splits;
    settings.log_rounds = true;
    Framebuffer framebuffer(kScene.width, kScene.height, FixedPoint::make(4, kScene.max_radiance));
    const RenderReport report = wavefront::WavefrontEngine(pool).render(kScene, settings, framebuffer);
    std::int64_t most = 0;
    for (const wavefront::RoundReport& round : wavefront::pool_report(report).rounds)
        most = std::max({most, round.records_in, round.records_out});
    return share(most, kBatch);
}
constexpr auto kMostRecords = []<class>(const auto& records, double splits, std::int64_t) {
    return records(static_cast<int>(splits));
};

}  // namespace

CaseMethods size_cases() {
    return {{"large-image", Methods(kWrongPixels).naive("int32", int32_pixel).ours("ours", our_pixel)},
            {"pixel-jitter", Methods(kJitterError).naive("pixel + jitter, float", kJoined).ours_in_both(kOurs)},
            {"splitting", Methods(kMostRecords).naive("all branches at once", all_at_once).ours("ours", in_our_pool)}};
}

}  // namespace raypool::stability
