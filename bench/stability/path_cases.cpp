// Rows 5a to 5e: paths that are long: their stack, their throughput, how they end, and their direction.

#include <algorithm>
#include <cmath>

#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "bench/stability/stack.h"
#include "core/film/framebuffer.h"
#include "core/math/random.h"
#include "core/runtime/engine.h"
#include "core/shading/shade.h"

namespace raypool::stability {

namespace {

constexpr auto kKilled = []<class>(Deep how, double depth, std::int64_t) {
    return survives(how, static_cast<std::int64_t>(depth)) ? 0 : 1;
};

/// What a thread does before it renders: nothing, or what the engines do.
struct AsItComes {};
/// Throughput after 20 000 bounces: 1 where it still is a denormal number.
template <class Denormals>
int stuck(double albedo) {
    [[maybe_unused]] const Denormals denormals;
    const auto factor = static_cast<float>(albedo);
    volatile float throughput = 1;
    for (int i = 0; i < 20'000; ++i) throughput = throughput * factor;
    const float left = throughput;
    return left != 0 && std::fabs(left) < std::numeric_limits<float>::min() ? 1 : 0;
}
constexpr auto kStuck = []<class>(const auto& is_stuck, double albedo, std::int64_t) { return is_stuck(albedo); };
template <class Denormals>
double time_multiply(std::int64_t calls) {
    [[maybe_unused]] const Denormals denormals;
    volatile float throughput = 1;
    for (std::int64_t i = 0; i < calls; ++i) throughput = throughput * 0.9F;
    return static_cast<double>(throughput);
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
constexpr auto kLightMissing = []<class Scalar>(const auto& judge, double depth, std::int64_t) {
    return judge(light_at_depth<Scalar>(static_cast<std::int64_t>(depth)), depth, static_cast<double>(Scalar(0.99)));
};
constexpr auto kCutOff = [](double light, double, double) { return 1 - light / 100; };
constexpr auto kFromClosedForm = [](double light, double depth, double albedo) {
    return std::abs(light / ((1 - std::pow(albedo, depth)) / (1 - albedo)) - 1);
};

// Ways to end a path by chance: each says whether it goes on, with its throughput made up for that.
constexpr auto kNaiveRoulette = []<class Scalar>(Scalar& throughput, Scalar random) {
    const Scalar q = std::min(Scalar(0.95F), throughput);
    throughput /= q;
    return random < q;
};
constexpr auto kOurRoulette = []<class Scalar>(Scalar& throughput, Scalar random) {
    Vec3<Scalar> grey = vec3<Scalar>(throughput, throughput, throughput);
    const bool survives = survives_roulette<Scalar>(grey, random, true);
    throughput = grey[0];
    return survives;
};
/// Light from within a closed sphere that shines with 1 and reflects 99 %, by so many paths that roulette alone ends:
/// the distance of their mean from 100, in standard errors of paths that end where light is absorbed.
constexpr auto kRouletteError = []<class Scalar>(const auto& survives, double paths, std::int64_t) {
    const auto count = static_cast<std::uint32_t>(paths);
    double sum = 0;
    for (std::uint32_t path = 0; path < count; ++path) {
        auto throughput = Scalar(1);
        bool is_alive = true;
        for (std::uint32_t hit = 0; is_alive && hit < 100'000; ++hit) {
            sum += static_cast<double>(throughput);
            throughput *= Scalar(0.99F);
            const Scalar random = random_block<Scalar>({path, 0}, hit, RandomPurpose::Scatter, random_seed(103))[3];
            is_alive = survives(throughput, random);
        }
    }
    const double albedo = static_cast<double>(0.99F);
    const double expected = 1 / (1 - albedo);
    return std::abs(sum / count - expected) / (std::sqrt(albedo) * expected / std::sqrt(count));
};

/// The mirrored direction, not made unit again.
constexpr auto kNaiveMirror = []<class Scalar>(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal) {
    return along<Scalar>(direction, -2 * dot<Scalar>(direction, normal), normal);
};
constexpr auto kOurMirror = [](const auto&... d_and_n) { return mirror_direction(d_and_n...); };
/// Length of a direction after so many mirrors.
constexpr auto kDrift = []<class Scalar>(const auto& mirror, double bounces, std::int64_t) {
    RandomInputs random(102);
    Vec3<Scalar> normals[64];
    for (Vec3<Scalar>& normal : normals) normal = random.direction<Scalar>();
    Vec3<Scalar> direction = random.direction<Scalar>();
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(bounces); ++i)
        direction = mirror(direction, normals[i % 64]);
    return std::min(std::abs(wide<Scalar>(direction).norm() - 1), 1.0);
};
template <class Mirror>
auto timed(Mirror mirror) {
    return [mirror](std::int64_t calls) { return kDrift.operator()<float>(mirror, static_cast<double>(calls), 0); };
}

}  // namespace

CaseMethods path_cases() {
    return {
        {"deep-recursion", Methods(kKilled)
                               .naive("recursion, unasked", Deep::Recursion)
                               .ours("ours, recursion that refuses", Deep::Checked)
                               .ours("ours, a loop", Deep::Loop)},
        {"denormals", Methods(kStuck)
                          .naive("as the processor comes, float", stuck<AsItComes>, time_multiply<AsItComes>)
                          .ours("ours, flushed to zero, float", stuck<FlushDenormals>, time_multiply<FlushDenormals>)},
        {"depth-limit", Methods(kLightMissing)
                            .naive("a limit that nobody mentions", kCutOff)
                            .ours<float>("ours, float, from 1 - albedo^depth", kFromClosedForm)
                            .ours<double>("ours, double, from 1 - albedo^depth", kFromClosedForm)},
        {"roulette", Methods(kRouletteError)
                         .naive("min(0.95, throughput), float", kNaiveRoulette)
                         .ours<float>("ours, min(1, throughput), float", kOurRoulette)
                         .ours<double>("ours, min(1, throughput), double", kOurRoulette)},
        {"direction-drift", Methods(kDrift)
                                .naive("not made unit again, float", kNaiveMirror, timed(kNaiveMirror))
                                .ours_in_both(kOurMirror, timed(kOurMirror))}};
}

}  // namespace raypool::stability
