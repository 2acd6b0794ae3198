#include "core/runtime/aovs.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <utility>

#include "core/base/first_exception.h"
#include "core/film/half_variance.h"
#include "core/geometry/traverse.h"
#include "core/math/flush_denormals.h"
#include "core/shading/camera.h"
#include "core/shading/interaction.h"

namespace raypool {

namespace {

/// Of a ray, or of several their sum: whether it meets a surface (1 or 0), the distance, the normal and the albedo.
struct FirstHit {
    enum Column { kAlpha, kDistance, kNormal, kAlbedo = kNormal + 3, kColumns = kAlbedo + 3 };
    std::array<double, kColumns> value{};
};

template <class Scalar>
FirstHit first_hit(const SceneView<Scalar>& scene, const RandomSeed& seed, std::int64_t pixel, std::int64_t sample) {
    using Row = SurfaceRow<Scalar>;
    const std::int64_t y = pixel / scene.width;
    const Ray<Scalar> ray = camera_ray<kEverything, Scalar>(scene.camera, static_cast<Scalar>(pixel - y * scene.width),
                                                            static_cast<Scalar>(y), static_cast<std::uint32_t>(pixel),
                                                            static_cast<std::uint32_t>(sample), seed);
    NoTestCount work;
    const Hit<Scalar> hit = closest_hit<kEverything, Scalar>(scene, ray, kNoPrimitive, work);
    if (hit.primitive_id == kNoPrimitive) return {};

    const Int<Scalar> primitive_id = hit.primitive_id;
    Scalar row[Row::kColumns];
    const TrianglePoint<Scalar> triangle = load_surface<kEverything, Scalar>(scene, ray, primitive_id, row);
    SurfacePoint<Scalar> point = surface_point<kEverything, Scalar>(ray, hit.t, row);
    triangle.place(point);
    const SurfaceCode<Int<Scalar>> code{bits_of<Scalar>(row[Row::kCode])};
    const SurfaceMaterial<kEverything, Scalar> material{code.material(), row[Row::kParameter]};
    const Scalar even = material.is_glass() ? 1 : 0;
    Vec3<Scalar> albedo = vec3<Scalar>(even, even, even);
    if (!material.is_glass() && !material.is_emitter())
        albedo = surface_colour<kEverything, Scalar>(scene, point, triangle, primitive_id, row, code, true);

    FirstHit found{{1, static_cast<double>(hit.t)}};
    for (int k = 0; k < 3; ++k) {
        found.value[static_cast<std::size_t>(FirstHit::kNormal + k)] = static_cast<double>(point.normal[k]);
        found.value[static_cast<std::size_t>(FirstHit::kAlbedo + k)] = static_cast<double>(albedo[k]);
    }
    return found;
}

std::int64_t pixel_count(const PixelWindow& window) {
    return (window.x_end - window.x_begin) * (window.y_end - window.y_begin);
}

/// The number in the scene's image of a pixel by its number in the window.
std::size_t pixel_of(const PixelWindow& window, std::int64_t place, std::int64_t scene_width) {
    const std::int64_t columns = window.x_end - window.x_begin;
    const std::int64_t row = place / columns;
    return static_cast<std::size_t>((window.y_begin + row) * scene_width + window.x_begin + place - row * columns);
}

std::vector<ImageChannel> make_channels(const PixelWindow& window,
                                        std::initializer_list<std::pair<const char*, bool>> names) {
    std::vector<ImageChannel> channels;
    for (const auto& [name, may_be_half] : names)
        channels.push_back({name, std::vector<float>(static_cast<std::size_t>(pixel_count(window))), may_be_half});
    return channels;
}

}  // namespace

template <class Scalar>
std::vector<ImageChannel> first_hit_channels(const CompiledScene<Scalar>& scene, const ImageSettings& settings,
                                             const ImageSamples& samples, int threads) {
    const PixelWindow& window = samples.window;
    std::vector<ImageChannel> channels = make_channels(window, {{"A", true},
                                                                {"Z", false},
                                                                {"N.X", true},
                                                                {"N.Y", true},
                                                                {"N.Z", true},
                                                                {"albedo.R", true},
                                                                {"albedo.G", true},
                                                                {"albedo.B", true}});
    const RandomSeed seed = random_seed(settings.seed, settings.sampler);
    const auto fill = [&](std::size_t place) {
        const std::size_t pixel = pixel_of(window, static_cast<std::int64_t>(place), scene.width);
        FirstHit sum;
        for (std::int64_t s = samples.begin_of(pixel); s < samples.end_of(pixel); ++s) {
            const FirstHit hit = first_hit<Scalar>(scene, seed, static_cast<std::int64_t>(pixel), s);
            for (std::size_t i = 0; i < FirstHit::kColumns; ++i) sum.value[i] += hit.value[i];
        }
        const auto count = static_cast<double>(samples.end_of(pixel) - samples.begin_of(pixel));
        for (std::size_t i = 0; i < FirstHit::kColumns; ++i)
            channels[i].values[place] = static_cast<float>(sum.value[i] / count);
        const double hits = sum.value[FirstHit::kAlpha];
        channels[FirstHit::kDistance].values[place] = hits > 0
                                                          ? static_cast<float>(sum.value[FirstHit::kDistance] / hits)
                                                          : std::numeric_limits<float>::infinity();
    };
    constexpr std::int64_t kPixelsAtOnce = 64;
    const std::int64_t count = pixel_count(window);
    FirstException failure;
#pragma omp parallel for num_threads(threads) schedule(dynamic)
    for (std::int64_t first = 0; first < count; first += kPixelsAtOnce) {
        const FlushDenormals flush;
        failure.run([&] {
            for (std::int64_t place = first; place < std::min(first + kPixelsAtOnce, count); ++place)
                fill(static_cast<std::size_t>(place));
        });
    }
    failure.rethrow();
    return channels;
}

template std::vector<ImageChannel> first_hit_channels(const CompiledScene<float>&, const ImageSettings&,
                                                      const ImageSamples&, int);
template std::vector<ImageChannel> first_hit_channels(const CompiledScene<double>&, const ImageSettings&,
                                                      const ImageSamples&, int);

std::vector<ImageChannel> variance_channels(const Framebuffer& framebuffer, const ImageSamples& samples) {
    std::vector<ImageChannel> channels = make_channels(
        samples.window, {{"samples", false}, {"variance.R", false}, {"variance.G", false}, {"variance.B", false}});
    const double scale = framebuffer.fixed_point().scale();
    for (std::int64_t i = 0; i < pixel_count(samples.window); ++i) {
        const std::size_t pixel = pixel_of(samples.window, i, framebuffer.width());
        const auto place = static_cast<std::size_t>(i);
        const HalfCounts counts = HalfCounts::of(pixel, samples.begin_of(pixel), samples.end_of(pixel));
        const std::array<double, 3> squares = squared_differences(framebuffer, pixel, counts);
        const auto n = static_cast<double>(counts.all());
        const double parts = n * n * static_cast<double>(counts.a) * static_cast<double>(counts.b);
        channels[0].values[place] = static_cast<float>(n);
        for (std::size_t k = 0; k < 3; ++k)
            channels[1 + k].values[place] = parts > 0 ? static_cast<float>(squares[k] / (scale * scale) / parts)
                                                      : std::numeric_limits<float>::infinity();
    }
    return channels;
}

}  // namespace raypool
