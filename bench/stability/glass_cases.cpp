// Rows 4b to 4e: glass met head on, at the critical angle, and where it must be invisible.

#include <algorithm>
#include <cmath>

#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/shading/materials.h"

namespace raypool::stability {

namespace {

// Ways to find the reflectance of light from outside (eta = 1 / 1.5) or from inside (1.5).
/// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994, with the cosine of the ray that arrives,
/// as in "Ray Tracing in One Weekend", chapter 11.4.
constexpr auto kSchlick = []<class Scalar>(Scalar cosine, Scalar eta) {
    const Scalar at_normal = (1 - eta) / (1 + eta);
    const Scalar r0 = at_normal * at_normal;
    const Scalar x = 1 - cosine;
    return r0 + (1 - r0) * (x * x * x * x * x);
};
constexpr auto kOurReflectance = []<class Scalar>(Scalar cosine, Scalar eta) {
    const Vec3<Scalar> normal = vec3<Scalar>(0, 1, 0);
    const Vec3<Scalar> direction = vec3<Scalar>(std::sqrt(1 - cosine * cosine), -cosine, 0);
    return fresnel_split<Scalar>(direction, normal, eta).reflectance;
};
/// Fresnel's equations without regard to eta = 1, where rounding reflects light at grazing angles.
constexpr auto kPlainFresnel = []<class Scalar>(Scalar cosine, Scalar eta) {
    const Scalar cos_out = std::sqrt(std::max(1 - eta * eta * (1 - cosine * cosine), Scalar(0)));
    const Scalar r_s = (eta * cosine - cos_out) / (eta * cosine + cos_out);
    const Scalar r_p = (cosine - eta * cos_out) / (cosine + eta * cos_out);
    return (r_s * r_s + r_p * r_p) / 2;
};

// Ways to split light at a surface of glass.
/// By the cosines of both sides, with Schlick's polynomial in place of Fresnel's equations.
template <class Scalar>
FresnelSplit<Scalar> split_in_books(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal, Scalar eta,
                                    Scalar cosine, Scalar cos_out) {
    return {kSchlick(cosine, eta), unit<Scalar>(Vec3<Scalar>(eta * direction + (eta * cosine - cos_out) * normal))};
}
/// Snell's law by the sine of a cosine that rounding may have put above 1: the sine is then not a number.
constexpr auto kUnclamped = []<class Scalar>(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal,
                                             Scalar eta) -> FresnelSplit<Scalar> {
    const Scalar cosine = -dot<Scalar>(direction, normal);
    const Scalar sine_out = eta * std::sqrt(1 - cosine * cosine);
    if (sine_out > 1) return {1, normal};
    return split_in_books<Scalar>(direction, normal, eta, cosine, std::sqrt(1 - sine_out * sine_out));
};
/// Total reflection is decided by the sine, and the root is taken of another form of the same number: where the two
/// disagree it is that of a negative one.
constexpr auto kSine = []<class Scalar>(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal,
                                        Scalar eta) -> FresnelSplit<Scalar> {
    const Scalar cosine = std::min(-dot<Scalar>(direction, normal), Scalar(1));
    if (eta * std::sqrt(1 - cosine * cosine) > 1) return {1, normal};
    return split_in_books<Scalar>(direction, normal, eta, cosine, std::sqrt(1 - eta * eta * (1 - cosine * cosine)));
};
constexpr auto kOurs = [](const auto&... hit_and_eta) { return fresnel_split(hit_and_eta...); };

/// A unit direction that arrives at an angle of that sine to the normal, as nearly as Scalar can say.
template <class Scalar>
struct Arrival {
    Vec3<Scalar> direction, normal;

    Arrival(RandomInputs& random, double sine) {
        const Vec3<double> n = random.direction<double>();
        const Vec3<double> side = perpendicular(random, n);
        normal = narrow<Scalar>(n);
        direction = narrow<Scalar>(sine * side - std::sqrt(1 - sine * sine) * n);
    }
    [[nodiscard]] Scalar cosine() const {
        return std::min(std::max(-dot<Scalar>(direction, normal), Scalar(1e-10)), Scalar(1));
    }
};

/// Whether a split of light at such an angle holds a not-a-number.
template <class Scalar>
bool is_bad_split(const auto& split, RandomInputs& random, double low_sine, double high_sine, Scalar eta) {
    const Arrival<Scalar> at(random, random.uniform(low_sine, high_sine));
    const FresnelSplit<Scalar> light = split(at.direction, at.normal, eta);
    return !std::isfinite(light.reflectance) || !light.refracted.allFinite();
}
constexpr auto kHeadOn = []<class Scalar>(const auto& split, double sine, std::int64_t rays) {
    return share_of(rays, RandomInputs(61), [&](RandomInputs& random) {
        return is_bad_split<Scalar>(split, random, 0, sine, 1 / Scalar(1.5));
    });
};
constexpr auto kCriticalAngle = []<class Scalar>(const auto& split, double part, std::int64_t rays) {
    return share_of(rays, RandomInputs(62), [&](RandomInputs& random) {
        return is_bad_split<Scalar>(split, random, (1 - part) / 1.5, (1 + part) / 1.5, Scalar(1.5));
    });
};

/// Against Fresnel's equations in long double. At the critical angle the reflectance has an edge, so there an error of
/// the angle shows as one of reflectance: angles are whole hundredths of the cosine.
std::vector<Method> reflectance_methods(double eta) {
    const auto error = [eta]<class Scalar>(const auto& reflectance, double cosine, std::int64_t) {
        const auto c = static_cast<Scalar>(cosine);
        const auto e = static_cast<Scalar>(eta);
        const Scalar ours = reflectance(c, e);
        return std::abs(
            static_cast<double>(ours - kOurReflectance(static_cast<long double>(c), static_cast<long double>(e))));
    };
    return Methods(error).naive("Schlick, float", kSchlick).ours_in_both(kOurReflectance);
}

/// What is reflected by glass of index 1, which is not there: the greatest of rays at about that cosine.
constexpr auto kGhost = []<class Scalar>(const auto& reflectance, double cosine, std::int64_t rays) {
    const auto judge = [&](RandomInputs& random, Errors& errors) {
        const double c = cosine * random.uniform(0.9, 1);
        errors.add(reflectance(Arrival<Scalar>(random, std::sqrt(1 - c * c))));
    };
    return errors_of(rays, RandomInputs(63), judge).max();
};
constexpr auto kSchlickGhost = [](const auto& at) { return kSchlick(at.cosine(), 1.0F); };
constexpr auto kFresnelGhost = [](const auto& at) { return kPlainFresnel(at.cosine(), 1.0F); };
/// Light that passes must go straight on.
constexpr auto kOurGhost = []<class Scalar>(const Arrival<Scalar>& at) {
    const FresnelSplit<Scalar> split = fresnel_split<Scalar>(at.direction, at.normal, Scalar(1));
    return split.refracted == at.direction ? split.reflectance : Scalar(1);
};

template <class Split>
auto timed(Split split) {
    const auto draw = [](RandomInputs& random) { return Arrival<float>(random, random.uniform(0, 0.999)); };
    return sum_over(RandomInputs(64), draw, [=](const Arrival<float>& at) {
        const FresnelSplit<float> light = split(at.direction, at.normal, 1 / 1.5F);
        return light.reflectance + light.refracted[0];
    });
}

}  // namespace

CaseMethods glass_cases() {
    return {{"head-on", Methods(kHeadOn)
                            .naive("cosine as it comes, float", kUnclamped, timed(kUnclamped))
                            .ours_in_both(kOurs, timed(kOurs))},
            {"critical-angle",
             Methods(kCriticalAngle).naive("sine test and another root, float", kSine).ours_in_both(kOurs)},
            {"reflectance-entering", reflectance_methods(1 / 1.5)},
            {"reflectance-leaving", reflectance_methods(1.5)},
            {"index-one", Methods(kGhost)
                              .naive("Schlick, float", kSchlickGhost)
                              .naive("Fresnel without a rule for it, float", kFresnelGhost)
                              .ours_in_both(kOurGhost)}};
}

}  // namespace raypool::stability
