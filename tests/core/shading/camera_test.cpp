/// Camera rays: where they start, what they look at, what the lens and the shutter add, and images of any size.
#include "core/shading/camera.h"

#include <set>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "tests/errors.h"
#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

constexpr Features kLens{.defocus = true};
constexpr Features kShutter{.motion = true};

CameraDescription looking_down_the_z_axis() {
    CameraDescription description;
    description.look_from = {1, 2, 10};
    description.look_at = {1, 2, 0};
    description.vertical_fov_degrees = 90;
    return description;
}

template <Features features, class Scalar>
Ray<Scalar> ray_through(const Camera<Scalar>& camera, std::int64_t width, std::int64_t x, std::int64_t y,
                        std::uint32_t sample) {
    return camera_ray<features, Scalar>(camera, Scalar(x), Scalar(y), static_cast<std::uint32_t>(y * width + x), sample,
                                        random_seed(0));
}

TEST(Camera, LooksAtLookAtWithYUpAndXToTheRight) {
    const Camera<double> camera = make_camera<double>(looking_down_the_z_axis(), 400, 200);
    const auto on_film = [&](std::int64_t x, std::int64_t y) {  // at unit distance, from the axis
        const Ray<double> ray = ray_through<Features{}>(camera, 400, x, y, 0);
        EXPECT_EQ(ray.origin, vec3<double>(1, 2, 10));
        EXPECT_LT(ray.direction[2], 0);
        EXPECT_NEAR(ray.direction.norm(), 1, 1e-15);
        return Eigen::Vector2d(ray.direction[0] / -ray.direction[2], ray.direction[1] / -ray.direction[2]);
    };
    // 90 degrees: the film is 2 high and 4 wide, a pixel 0.01.
    EXPECT_TRUE(on_film(0, 0).isApprox(Eigen::Vector2d(-2 + 0.005, 1 - 0.005), 0.006));
    EXPECT_TRUE(on_film(399, 0).isApprox(Eigen::Vector2d(2 - 0.005, 1 - 0.005), 0.006));
    EXPECT_TRUE(on_film(0, 199).isApprox(Eigen::Vector2d(-2 + 0.005, -1 + 0.005), 0.006));
    EXPECT_LT(on_film(200, 100).norm(), 0.015);
}

TEST(Camera, PlacesSamplesWithinTheirPixel) {
    constexpr int kWidth = 40, kHeight = 20;
    const Camera<double> camera = make_camera<double>(looking_down_the_z_axis(), kWidth, kHeight);
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (int i = 0; i < kInputs; ++i) {
        const int x = i % kWidth, y = i / kWidth % kHeight;
        const Ray<double> ray = ray_through<Features{}>(camera, kWidth, x, y, static_cast<std::uint32_t>(i / 800));
        const double column = ray.direction[0] / -ray.direction[2] * 10 + kWidth / 2 - x;
        const double row = -ray.direction[1] / -ray.direction[2] * 10 + kHeight / 2 - y;
        ASSERT_TRUE(column > -1e-12 && column < 1 + 1e-12 && row > -1e-12 && row < 1 + 1e-12);
        mean += Eigen::Vector2d(column, row) / kInputs;
    }
    EXPECT_NEAR(mean.x(), 0.5, 2 / std::sqrt(kInputs));
    EXPECT_NEAR(mean.y(), 0.5, 2 / std::sqrt(kInputs));
}

TEST(Camera, SendsAllRaysOfAFilmPointThroughOnePointInFocus) {
    CameraDescription description = looking_down_the_z_axis();
    description.defocus_angle_degrees = 10;
    description.focus_distance = 7;
    constexpr int kSize = 100;
    const Camera<double> sharp = make_camera<double>(looking_down_the_z_axis(), kSize, kSize);
    const Camera<double> camera = make_camera<double>(description, kSize, kSize);
    const double lens_radius = 7 * std::tan(5 * std::numbers::pi / 180);
    double widest = 0;
    for (std::uint32_t sample = 0; sample < 2000; ++sample) {
        const Ray<double> pinhole = ray_through<Features{}>(sharp, kSize, 30, 20, sample);
        const Ray<double> ray = ray_through<kLens>(camera, kSize, 30, 20, sample);
        const double t = (3 - ray.origin[2]) / ray.direction[2];  // the plane of focus is at z = 10 - 7
        const double t_sharp = (3 - pinhole.origin[2]) / pinhole.direction[2];
        const Vec3<double> in_focus = ray.origin + t * ray.direction;
        ASSERT_LT((in_focus - pinhole.origin - t_sharp * pinhole.direction).norm(), 1e-12);
        ASSERT_EQ(ray.origin[2], 10);
        const double aside = (ray.origin - pinhole.origin).norm();
        ASSERT_LE(aside, lens_radius * (1 + 1e-12));
        widest = std::max(widest, aside);
    }
    EXPECT_GT(widest, 0.99 * lens_radius);
}

TEST(Camera, WithoutALensGivesTheSameBitsWhereTheLensIsLeftOut) {
    const Camera<float> camera = make_camera<float>(looking_down_the_z_axis(), 300, 200);
    for (std::uint32_t i = 0; i < 60'000; ++i) {
        const Ray<float> with = ray_through<kEverything>(camera, 300, i % 300, i / 300, i % 7);
        const Ray<float> without = ray_through<Features{}>(camera, 300, i % 300, i / 300, i % 7);
        ASSERT_EQ(with.origin, without.origin);
        ASSERT_EQ(with.direction, without.direction);
    }
}

TEST(Camera, SpreadsTimesOverTheOpenShutter) {
    CameraDescription description = looking_down_the_z_axis();
    description.shutter_open = 0.25;
    description.shutter_close = 0.75;
    const Camera<float> camera = make_camera<float>(description, 10, 10);
    double sum = 0;
    constexpr int kTimes = 100'000;
    for (std::uint32_t sample = 0; sample < kTimes; ++sample) {
        const float time = ray_through<kShutter>(camera, 10, 3, 4, sample).time;
        ASSERT_TRUE(time >= 0.25F && time < 0.75F) << time;
        sum += time;
    }
    EXPECT_NEAR(sum / kTimes, 0.5, 0.002);
}

/// Places in the pixel and on the lens and times, as a render draws them; with the samples of a pixel spread evenly the
/// statistic can only be too small.
TEST(Camera, SpreadsSamplesUniformlyOverPixelLensAndShutter) {
    constexpr int kWidth = 40, kHeight = 20;
    CameraDescription description = looking_down_the_z_axis();
    description.defocus_angle_degrees = 2;
    description.focus_distance = 10;
    description.shutter_close = 1;
    const Camera<double> camera = make_camera<double>(description, kWidth, kHeight);
    for (const Sampler sampler : {Sampler::Independent, Sampler::Sobol}) {
        Grid film, lens, time_of_place;
        for (std::uint32_t i = 0; i < kDraws; ++i) {
            const std::uint32_t pixel = i % (kWidth * kHeight), x = pixel % kWidth, y = pixel / kWidth;
            const Ray<double> ray =
                camera_ray<kEverything, double>(camera, x, y, pixel, i / (kWidth * kHeight), random_seed(0, sampler));
            const Vec3<double> shift = ray.origin - camera.origin;
            const double u = shift.dot(camera.lens_u) / camera.lens_u.squaredNorm();
            const double v = shift.dot(camera.lens_v) / camera.lens_v.squaredNorm();
            lens.add(u * u + v * v, std::atan2(v, u) / (2 * std::numbers::pi) + 0.5);

            const double focus = description.focus_distance / -ray.direction[2];
            const Vec3<double> at = shift + focus * ray.direction - camera.to_center;
            const double column = at.dot(camera.pixel_u) / camera.pixel_u.squaredNorm() + kWidth / 2 - x;
            const double row = at.dot(camera.pixel_v) / camera.pixel_v.squaredNorm() + kHeight / 2 - y;
            film.add(column, row);
            time_of_place.add(ray.time, column);
        }
        for (const Grid* grid : {&film, &lens, &time_of_place})
            EXPECT_FALSE(is_significant(grid->p_value(), 6)) << grid->p_value();
    }
}

/// The largest image there may be: a pixel is 1e-5 of the film, and float holds 24 bits.
TEST(Camera, KeepsTheJitterOfAVeryLargeImage) {
    constexpr std::int64_t kSize = 65536;
    CameraDescription description = looking_down_the_z_axis();
    const Camera<float> camera = make_camera<float>(description, kSize, kSize);
    const Camera<double> exact = make_camera<double>(description, kSize, kSize);
    const auto film_x = [](const auto& ray) {
        return static_cast<double>(ray.direction[0]) / -static_cast<double>(ray.direction[2]) * (kSize / 2);
    };
    std::set<float> places;
    Errors errors;
    constexpr std::int64_t kMiddle = kSize / 2 + 20;  // where pixel + jitter in float has 256 places a pixel
    for (std::uint32_t sample = 0; sample < 4096; ++sample) {
        places.insert(ray_through<Features{}>(camera, kSize, kMiddle, kMiddle, sample).direction[0]);
        for (const std::int64_t x : {std::int64_t{0}, kMiddle, kSize - 1}) {
            const Ray<float> ray = ray_through<Features{}>(camera, kSize, x, kSize - 1, sample);
            errors.add(film_x(ray) - film_x(ray_through<Features{}>(exact, kSize, x, kSize - 1, sample)));
        }
    }
    EXPECT_GT(places.size(), 4000U);
    EXPECT_LT(errors.max(), 0.02);  // of a pixel
}

TEST(Camera, GivesTheLastPixelOfTheLargestImageAKeyOfItsOwn) {
    constexpr std::int64_t kSize = 65536;
    const auto pixel = static_cast<std::uint32_t>((kSize - 1) * kSize + kSize - 1);
    EXPECT_EQ(pixel, 0xffffffffU);
    const RandomSeed seed = random_seed(0);
    EXPECT_NE(random_block<float>({pixel, 0}, 0, RandomPurpose::Film, seed),
              random_block<float>({0, 0}, 0, RandomPurpose::Film, seed));
    EXPECT_NE(random_block<float>({pixel, 0}, 0, RandomPurpose::Film, seed),
              random_block<float>({pixel - 1, 0}, 0, RandomPurpose::Film, seed));
}

}  // namespace
}  // namespace raypool::test
