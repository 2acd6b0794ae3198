// Rows 4a, 4f and 4g: directions that cancel, that leave the surface on the wrong side, and numbers that are not
// below 1.

#include <algorithm>
#include <cmath>

#include "bench/naive/random.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

/// normal + a point of the unit sphere, whatever is left of it.
constexpr auto kNaiveDiffuse = []<class Scalar>(const Vec3<Scalar>& normal, const Vec3<Scalar>& on_sphere) {
    return unit<Scalar>(Vec3<Scalar>(normal + on_sphere));
};
constexpr auto kOurDiffuse = [](const auto&... n_and_u) { return diffuse_direction(n_and_u...); };
/// Points of the unit sphere so close to the opposite of the normal, 0 for the very opposite: what is no direction.
constexpr auto kNoDirection = []<class Scalar>(const auto& diffuse, double apart, std::int64_t points) {
    return share_of(points, RandomInputs(51), [&](RandomInputs& random) {
        const Vec3<double> n = random.direction<double>();
        const Vec3<double> u = -n + apart * random.direction<double>();
        const Vec3<Scalar> direction = diffuse(narrow<Scalar>(n), narrow<Scalar>(u));
        return !(std::abs(direction.norm() - 1) < Scalar(1e-3));  // true for NaN
    });
};

/// v scaled by its greatest component first: for lengths whose square is no number.
constexpr auto kScaledUnit = []<class Scalar>(const Vec3<Scalar>& v) {
    const Scalar greatest = v.cwiseAbs().maxCoeff();
    return unit<Scalar>(vec3<Scalar>(v[0] / greatest, v[1] / greatest, v[2] / greatest));
};
constexpr auto kOurUnit = [](const auto& v) { return unit(v); };
/// Vectors of length 10^-e and 10^e: how far from 1 the length of what should be unit is.
constexpr auto kUnitError = []<class Scalar>(const auto& made_unit, double exponent, std::int64_t vectors) {
    const Errors errors = errors_of(vectors, RandomInputs(52), [&](RandomInputs& random, Errors& all) {
        const double length = std::pow(10, random.one_in(2) ? exponent : -exponent);
        const Vec3<Scalar> v = narrow<Scalar>(length * random.direction<double>());
        all.add(wide<Scalar>(made_unit(v)).norm() - 1);
    });
    return quantile_up_to_one(errors, 1);
};

/// Directions of a fuzzy mirror that go below the surface: light that is lost.
template <class Scalar>
double lost_below(double fuzz, double degrees, std::int64_t samples) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3<Scalar> normal = vec3<Scalar>(0, 1, 0);
    const Vec3<Scalar> arriving = narrow<Scalar>(Vec3<double>(std::sin(angle), -std::cos(angle), 0));
    const Vec3<Scalar> mirrored = mirror_direction<Scalar>(arriving, normal);
    return share_of(samples, RandomInputs(53), [&](RandomInputs& random) {
        const auto [u, v] = random.unit_square<Scalar>();
        const Vec3<Scalar> out =
            fuzzy_direction<Scalar>(mirrored, static_cast<Scalar>(fuzz), unit_sphere<Scalar>(u, v));
        return dot<Scalar>(out, normal) <= 0;
    });
}
/// The loss is the model's, the same for every method: a part of a sphere of radius `fuzz` around the mirrored
/// direction lies below. Ours must lose just that.
std::vector<Method> fuzz_methods(double fuzz) {
    const auto lost = [fuzz]<class Scalar>(const auto& judge, double degrees, std::int64_t samples) {
        const double cosine = std::cos(degrees * std::numbers::pi / 180);
        return judge(lost_below<Scalar>(fuzz, degrees, samples), std::max(0.0, (1 - cosine / fuzz) / 2));
    };
    const auto absorbed = [](double loss, double) { return loss; };
    const auto from_expected = [](double loss, double expected) { return std::abs(loss - expected); };
    return Methods(lost)
        .other("what is absorbed", absorbed)
        .ours<float>("ours, float, from the model's share", from_expected)
        .ours<double>("ours, double, from the model's share", from_expected);
}

/// The greatest words of 32 bits that make the float 1: a number that is to be below 1.
constexpr auto kNotBelowOne = []<class>(const auto& to_unit, double words, std::int64_t) {
    std::uint32_t word = 0;
    return share_of(static_cast<std::int64_t>(words), RandomInputs(0),
                    [&](RandomInputs&) { return !(to_unit(--word) < 1.0F); });
};

}  // namespace

CaseMethods scattering_cases() {
    return {
        {"diffuse-cancels", Methods(kNoDirection).naive("no guard, float", kNaiveDiffuse).ours_in_both(kOurDiffuse)},
        {"unit-vector",
         Methods(kUnitError).other("scaled by the greatest first, float", kScaledUnit).ours_in_both(kOurUnit)},
        {"fuzz-below-0.3", fuzz_methods(0.3)},
        {"fuzz-below-1", fuzz_methods(1)},
        {"below-one", Methods(kNotBelowOne)
                          .naive("word / 2^32, float", naive::word_to_unit)
                          .ours("ours, 24 bits, float", naive::high_bits_to_unit)}};
}

}  // namespace raypool::stability
