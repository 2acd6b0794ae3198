// Rows 4a, 4f and 4g: directions that cancel, that leave the surface on the wrong side, and numbers that are not
// below 1.

#include <cmath>

#include "bench/naive/random.h"
#include "bench/naive/scattering.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

template <class Scalar>
bool is_unit(const Vec3<Scalar>& v) {
    return std::abs(v.norm() - 1) < Scalar(1e-3);  // false for NaN
}

struct NaiveDiffuse {
    template <class Scalar>
    static Vec3<Scalar> direction(const Vec3<Scalar>& n, const Vec3<Scalar>& u) {
        return naive::diffuse_direction<Scalar>(n, u);
    }
};
struct OurDiffuse {
    template <class Scalar>
    static Vec3<Scalar> direction(const Vec3<Scalar>& n, const Vec3<Scalar>& u) {
        return diffuse_direction<Scalar>(n, u);
    }
};
/// Points of the unit sphere so close to the opposite of the normal, 0 for the very opposite: what is no direction.
template <class Scalar, class Diffuse>
double no_direction(double apart, std::int64_t points) {
    RandomInputs random(51);
    std::int64_t bad = 0;
    for (std::int64_t i = 0; i < points; ++i) {
        const Vec3<double> n = random.direction<double>();
        const Vec3<double> u = -n + apart * random.direction<double>();
        bad += is_unit<Scalar>(Diffuse::template direction<Scalar>(narrow<Scalar>(n), narrow<Scalar>(u))) ? 0 : 1;
    }
    return share(bad, points);
}

struct OurUnit {
    template <class Scalar>
    static Vec3<Scalar> of(const Vec3<Scalar>& v) {
        return unit<Scalar>(v);
    }
};
struct ScaledUnit {
    template <class Scalar>
    static Vec3<Scalar> of(const Vec3<Scalar>& v) {
        return naive::scaled_unit<Scalar>(v);
    }
};
/// Vectors of length 10^-e and 10^e: how far from 1 the length of what should be unit is.
template <class Scalar, class Unit>
double unit_error(double exponent, std::int64_t vectors) {
    RandomInputs random(52);
    Errors errors;
    for (std::int64_t i = 0; i < vectors; ++i) {
        const double length = std::pow(10, random.one_in(2) ? exponent : -exponent);
        const Vec3<Scalar> v = narrow<Scalar>(length * random.direction<double>());
        errors.add(wide<Scalar>(Unit::template of<Scalar>(v)).norm() - 1);
    }
    return std::min(errors.max(), 1.0);
}

/// Directions of a fuzzy mirror that go below the surface, against what the model says: part of a sphere of that
/// radius around the mirrored direction lies below. A loss of the model, the same for every method.
template <class Scalar>
double fuzz_below(double degrees, std::int64_t samples, double fuzz) {
    RandomInputs random(53);
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3<Scalar> normal = vec3<Scalar>(0, 1, 0);
    const Vec3<Scalar> arriving = narrow<Scalar>(Vec3<double>(std::sin(angle), -std::cos(angle), 0));
    const Vec3<Scalar> mirrored = mirror_direction<Scalar>(arriving, normal);
    std::int64_t below = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        const auto [u, v] = random.unit_square<Scalar>();
        const Vec3<Scalar> out =
            fuzzy_direction<Scalar>(mirrored, static_cast<Scalar>(fuzz), unit_sphere<Scalar>(u, v));
        below += dot<Scalar>(out, normal) <= 0 ? 1 : 0;
    }
    return share(below, samples);
}

/// The greatest 2^-k words of 32 bits that make the float 1: a number that is to be below 1.
template <class ToUnit>
double not_below_one(double words, std::int64_t, ToUnit to_unit) {
    const auto count = static_cast<std::int64_t>(words);
    std::int64_t ones = 0;
    for (std::int64_t i = 1; i <= count; ++i) ones += to_unit(static_cast<std::uint32_t>(-i)) < 1.0F ? 0 : 1;
    return share(ones, count);
}

}  // namespace

std::vector<Case> scattering_cases() {
    std::vector<Case> cases;
    cases.push_back({.id = "diffuse-cancels",
                     .row = "4a",
                     .parameter = "distance from the normal's opposite",
                     .values = {1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 0},
                     .measure = "directions that are none, share",
                     .tolerance = 0,
                     .symptom = "not-a-numbers: black or white pixels that never go away",
                     .samples = 50'000,
                     .methods = {{"no guard, float", Kind::Naive, no_direction<float, NaiveDiffuse>},
                                 {"ours, float", Kind::Ours, no_direction<float, OurDiffuse>},
                                 {"ours, double", Kind::Ours, no_direction<double, OurDiffuse>}}});
    cases.push_back(
        {.id = "unit-vector",
         .row = "4a",
         .parameter = "e: lengths of 10^-e and 10^e",
         .values = {0, 5, 10, 15, 18, 20, 23, 30},
         .measure = "length of the unit vector, greatest error",
         .tolerance = 3e-7,
         .symptom = "scenes in the wrong unit turn black",
         .samples = 20'000,
         .methods = {{"scaled by the greatest first, float", Kind::Alternative, unit_error<float, ScaledUnit>},
                     {"ours, float", Kind::Ours, unit_error<float, OurUnit>},
                     {"ours, double", Kind::Ours, unit_error<double, OurUnit>}},
         .held = 5,
         .limit = "lengths whose squares are no normal numbers of their type are outside of unit()'s range"});
    for (const double fuzz : {0.3, 1.0}) {
        const auto wrong = [fuzz](auto scalar) {
            return [fuzz](double degrees, std::int64_t samples) {
                const double cosine = std::cos(degrees * std::numbers::pi / 180);
                const double expected = std::max(0.0, (1 - cosine / fuzz) / 2);
                return std::abs(fuzz_below<decltype(scalar)>(degrees, samples, fuzz) - expected);
            };
        };
        const auto lost = [fuzz](double degrees, std::int64_t samples) {
            return fuzz_below<float>(degrees, samples, fuzz);
        };
        cases.push_back({.id = fuzz < 1 ? "fuzz-below-0.3" : "fuzz-below-1",
                         .row = "4f",
                         .parameter = "angle of arrival, degrees",
                         .values = {0, 30, 60, 75, 85, 89},
                         .measure = "light absorbed below the surface, and its distance from the model's share",
                         .tolerance = 0.02,
                         .symptom = "a white fuzzy mirror is grey at grazing angles; the model's doing",
                         .samples = 100'000,
                         .methods = {{"what is absorbed", Kind::Alternative, lost},
                                     {"ours, float, from the model's share", Kind::Ours, wrong(0.0F)},
                                     {"ours, double, from the model's share", Kind::Ours, wrong(0.0)}}});
    }
    const auto naive_word = [](double words, std::int64_t n) { return not_below_one(words, n, naive::word_to_unit); };
    const auto our_word = [](double words, std::int64_t n) {
        return not_below_one(words, n, naive::high_bits_to_unit);
    };
    cases.push_back(
        {.id = "below-one",
         .row = "4g",
         .parameter = "words of 32 bits, from the top",
         .values = {65'536, 4096, 512, 128, 1},
         .measure = "numbers that are 1 and not below it, share",
         .tolerance = 0,
         .symptom = "one sample in 33 million leaves its table, its pixel or the sphere",
         .methods = {{"word / 2^32, float", Kind::Naive, naive_word}, {"ours, 24 bits, float", Kind::Ours, our_word}}});
    return cases;
}

}  // namespace raypool::stability
