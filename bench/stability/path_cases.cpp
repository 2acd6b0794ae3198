// Rows 5a to 5e: paths that are long: their stack, their throughput, how they end, and their direction.

#include <cmath>

#include "bench/naive/scattering.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "bench/stability/stack.h"
#include "core/film/framebuffer.h"
#include "core/math/random.h"
#include "core/runtime/engine.h"
#include "core/shading/shade.h"

namespace raypool::stability {

namespace {

template <Deep how>
double killed(double depth, std::int64_t) {
    return survives(how, static_cast<std::int64_t>(depth)) ? 0 : 1;
}

/// Throughput after 20 000 bounces: 1 where it still is a denormal number.
double stuck(float albedo) {
    volatile float throughput = 1;
    for (int i = 0; i < 20'000; ++i) throughput = throughput * albedo;
    const float left = throughput;
    return left != 0 && std::fabs(left) < std::numeric_limits<float>::min() ? 1 : 0;
}
double stuck_denormal(double albedo, std::int64_t) {
    return stuck(static_cast<float>(albedo));
}
double stuck_flushed(double albedo, std::int64_t) {
    const FlushDenormals flush;
    return stuck(static_cast<float>(albedo));
}
double time_multiply(std::int64_t calls) {
    volatile float throughput = 1;
    for (std::int64_t i = 0; i < calls; ++i) throughput = throughput * 0.9F;
    return static_cast<double>(throughput);
}
double time_flushed(std::int64_t calls) {
    const FlushDenormals flush;
    return time_multiply(calls);
}

/// Light from within a closed sphere that shines with 1 and reflects 99 %, at a limit of depth, as the kernels give it.
template <class Scalar>
double light_at_depth(std::int64_t depth) {
    constexpr auto kAlbedo = Scalar(0.99);
    RandomInputs random(101);
    const Vec3<Scalar> center = vec3<Scalar>(0, 0, 0);
    Ray<Scalar> ray{center, random.direction<Scalar>(), 0};
    const FixedPoint fixed = FixedPoint::make(1, 128);
    SampleConverter converter(fixed);
    std::int64_t sum = 0;
    auto throughput = Scalar(1);
    for (std::int64_t i = 0; i < depth; ++i) {
        const Scalar t = sphere_distance<Scalar>(ray.origin, ray.direction, center, Scalar(1), i > 0);
        if (!(t < kInfinity<Scalar>)) return 0;
        sum += converter.convert<Scalar>(vec3<Scalar>(throughput, 0, 0))[0];
        throughput *= kAlbedo;
        const SurfacePoint<Scalar> point = sphere_point<Scalar>(ray, t, center, Scalar(1));
        const auto [u, v] = random.unit_square<Scalar>();
        ray.origin = point.position;
        ray.direction = diffuse_direction<Scalar>(point.normal, unit_sphere<Scalar>(u, v));
    }
    return static_cast<double>(sum) / fixed.scale();
}
double cut_off(double depth, std::int64_t) {
    return 1 - light_at_depth<float>(static_cast<std::int64_t>(depth)) / 100;
}
template <class Scalar>
double cut_off_from_closed_form(double depth, std::int64_t) {
    const auto albedo = static_cast<double>(Scalar(0.99));
    const double expected = (1 - std::pow(albedo, depth)) / (1 - albedo);
    return std::abs(light_at_depth<Scalar>(static_cast<std::int64_t>(depth)) / expected - 1);
}

/// Ends a path by chance: says whether it goes on, with its throughput made up for that.
struct NaiveRoulette {
    template <class Scalar>
    static bool survives(Scalar& throughput, Scalar random) {
        const Scalar q = std::min(Scalar(0.95F), throughput);
        throughput /= q;
        return random < q;
    }
};
struct OurRoulette {
    template <class Scalar>
    static bool survives(Scalar& throughput, Scalar random) {
        Vec3<Scalar> grey = vec3<Scalar>(throughput, throughput, throughput);
        const bool survives = survives_roulette<Scalar>(grey, random, true);
        throughput = grey[0];
        return survives;
    }
};
/// Light from within a closed sphere that shines with 1 and reflects 99 %, by so many paths that roulette alone ends:
/// the distance of their mean from 100, in standard errors of paths that end where light is absorbed.
template <class Scalar, class Roulette>
double roulette_error(double paths, std::int64_t) {
    const auto count = static_cast<std::uint32_t>(paths);
    double sum = 0;
    for (std::uint32_t path = 0; path < count; ++path) {
        auto throughput = Scalar(1);
        bool is_alive = true;
        for (std::uint32_t hit = 0; is_alive && hit < 100'000; ++hit) {
            sum += static_cast<double>(throughput);
            throughput *= Scalar(0.99F);
            const Scalar random = random_block<Scalar>({path, 0}, hit, RandomPurpose::Scatter, random_seed(103))[3];
            is_alive = Roulette::template survives<Scalar>(throughput, random);
        }
    }
    const double albedo = static_cast<double>(0.99F);
    const double expected = 1 / (1 - albedo);
    return std::abs(sum / count - expected) / (std::sqrt(albedo) * expected / std::sqrt(count));
}

struct NaiveMirror {
    template <class Scalar>
    static Vec3<Scalar> direction(const Vec3<Scalar>& d, const Vec3<Scalar>& n) {
        return naive::mirror_direction<Scalar>(d, n);
    }
};
struct OurMirror {
    template <class Scalar>
    static Vec3<Scalar> direction(const Vec3<Scalar>& d, const Vec3<Scalar>& n) {
        return mirror_direction<Scalar>(d, n);
    }
};
/// Length of a direction after so many mirrors.
template <class Scalar, class Mirror>
double drift(double bounces, std::int64_t) {
    RandomInputs random(102);
    Vec3<Scalar> normals[64];
    for (Vec3<Scalar>& normal : normals) normal = random.direction<Scalar>();
    Vec3<Scalar> direction = random.direction<Scalar>();
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(bounces); ++i)
        direction = Mirror::template direction<Scalar>(direction, normals[i % 64]);
    return std::min(std::abs(wide<Scalar>(direction).norm() - 1), 1.0);
}
template <class Mirror>
double time_mirror(std::int64_t calls) {
    return drift<float, Mirror>(static_cast<double>(calls), 0);
}

}  // namespace

std::vector<Case> path_cases() {
    std::vector<Case> cases;
    cases.push_back({.id = "deep-recursion",
                     .row = "5a",
                     .parameter = "depth, on a stack of 8 MB",
                     .values = {1e2, 1e3, 1e4, 1e5, 1e6},
                     .measure = "processes killed",
                     .tolerance = 0,
                     .symptom = "the program is gone: stack overflow",
                     .methods = {{"recursion, unasked", Kind::Naive, killed<Deep::Recursion>},
                                 {"ours, recursion that refuses", Kind::Ours, killed<Deep::Checked>},
                                 {"ours, a loop", Kind::Ours, killed<Deep::Loop>}}});
    cases.push_back(
        {.id = "denormals",
         .row = "5b",
         .parameter = "albedo",
         .values = {0.4, 0.6, 0.8, 0.9, 0.97},
         .measure = "throughputs that never reach 0",
         .tolerance = 0,
         .symptom = "none but time: faded paths go on for ever, and on some processors cost a hundred times more",
         .methods = {{"as the processor comes, float", Kind::Naive, stuck_denormal, time_multiply},
                     {"ours, flushed to zero, float", Kind::Ours, stuck_flushed, time_flushed}}});
    cases.push_back(
        {.id = "depth-limit",
         .row = "5c",
         .parameter = "depth, albedo 0.99",
         .values = {1000, 500, 125, 50, 20, 5},
         .measure = "light cut off, part; ours: distance from the closed form",
         .tolerance = 1e-5,
         .symptom = "bright rooms are too dark",
         .methods = {{"a limit that nobody mentions", Kind::Naive, cut_off},
                     {"ours, float, from 1 - albedo^depth", Kind::Ours, cut_off_from_closed_form<float>},
                     {"ours, double, from 1 - albedo^depth", Kind::Ours, cut_off_from_closed_form<double>}}});
    cases.push_back(
        {.id = "roulette",
         .row = "5d",
         .parameter = "paths",
         .values = {1e3, 1e4, 1e5},
         .measure = "distance of the mean from the closed form, standard errors",
         .tolerance = 4,
         .symptom = "fireflies that no number of samples averages out",
         .methods = {{"min(0.95, throughput), float", Kind::Naive, roulette_error<float, NaiveRoulette>},
                     {"ours, min(1, throughput), float", Kind::Ours, roulette_error<float, OurRoulette>},
                     {"ours, min(1, throughput), double", Kind::Ours, roulette_error<double, OurRoulette>}}});
    cases.push_back(
        {.id = "direction-drift",
         .row = "5e",
         .parameter = "bounces",
         .values = {1e2, 1e3, 1e4, 1e5, 1e6},
         .measure = "length of the direction, error",
         .tolerance = 3e-7,
         .symptom = "long paths meet nothing, or everything",
         .methods = {{"not made unit again, float", Kind::Naive, drift<float, NaiveMirror>, time_mirror<NaiveMirror>},
                     {"ours, float", Kind::Ours, drift<float, OurMirror>, time_mirror<OurMirror>},
                     {"ours, double", Kind::Ours, drift<double, OurMirror>}}});
    return cases;
}

}  // namespace raypool::stability
