// Rows 4b to 4e: glass met head on, at the critical angle, and where it must be invisible.

#include <cmath>

#include "bench/naive/scattering.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

struct Sine {
    template <class Scalar>
    static FresnelSplit<Scalar> split(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal, Scalar eta) {
        return naive::sine_dielectric<Scalar>(direction, normal, eta);
    }
};
struct Unclamped {
    template <class Scalar>
    static FresnelSplit<Scalar> split(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal, Scalar eta) {
        return naive::unclamped_dielectric<Scalar>(direction, normal, eta);
    }
};
struct Ours {
    template <class Scalar>
    static FresnelSplit<Scalar> split(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal, Scalar eta) {
        return fresnel_split<Scalar>(direction, normal, eta);
    }
};

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
};

/// Splits that hold a not-a-number.
template <class Scalar, class Glass>
double bad_splits(RandomInputs& random, double low_sine, double high_sine, Scalar eta, std::int64_t rays) {
    std::int64_t bad = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        const Arrival<Scalar> at(random, random.uniform(low_sine, high_sine));
        const FresnelSplit<Scalar> split = Glass::template split<Scalar>(at.direction, at.normal, eta);
        bad += std::isfinite(split.reflectance) && split.refracted.allFinite() ? 0 : 1;
    }
    return share(bad, rays);
}
template <class Scalar, class Glass>
double head_on(double sine, std::int64_t rays) {
    RandomInputs random(61);
    return bad_splits<Scalar, Glass>(random, 0, sine, 1 / Scalar(1.5), rays);
}
template <class Scalar, class Glass>
double critical_angle(double part, std::int64_t rays) {
    RandomInputs random(62);
    return bad_splits<Scalar, Glass>(random, (1 - part) / 1.5, (1 + part) / 1.5, Scalar(1.5), rays);
}

/// Of light from outside (eta = 1 / 1.5) or from inside (1.5).
struct SchlickSplit {
    template <class Scalar>
    static Scalar reflectance(Scalar cosine, Scalar eta) {
        return naive::schlick<Scalar>(cosine, eta);
    }
};
struct OurSplit {
    template <class Scalar>
    static Scalar reflectance(Scalar cosine, Scalar eta) {
        const Vec3<Scalar> normal = vec3<Scalar>(0, 1, 0);
        const Vec3<Scalar> direction = vec3<Scalar>(std::sqrt(1 - cosine * cosine), -cosine, 0);
        return fresnel_split<Scalar>(direction, normal, eta).reflectance;
    }
};
/// Against Fresnel's equations in long double. At the critical angle the reflectance has an edge, so there an error of
/// the angle shows as one of reflectance: angles are whole hundredths of the cosine.
template <class Scalar, class Split>
double reflectance_error(double cosine, std::int64_t, double eta) {
    const auto exact = OurSplit::reflectance<long double>(static_cast<Scalar>(cosine), static_cast<Scalar>(eta));
    const Scalar ours = Split::template reflectance<Scalar>(static_cast<Scalar>(cosine), static_cast<Scalar>(eta));
    return std::abs(static_cast<double>(ours - exact));
}
template <class Scalar, class Split>
auto reflectance_error_at(double eta) {
    return [eta](double cosine, std::int64_t n) { return reflectance_error<Scalar, Split>(cosine, n, eta); };
}

/// What is reflected by glass of index 1, which is not there: the greatest of rays at about that cosine.
template <class Scalar, class Reflectance>
double ghost(double cosine, std::int64_t rays, Reflectance reflectance) {
    RandomInputs random(63);
    double greatest = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        const double c = cosine * random.uniform(0.9, 1);
        const Arrival<Scalar> at(random, std::sqrt(1 - c * c));
        greatest = std::max(greatest, static_cast<double>(reflectance(at)));
    }
    return greatest;
}
template <class Scalar>
Scalar cosine_of(const Arrival<Scalar>& at) {
    return std::min(std::max(-dot<Scalar>(at.direction, at.normal), Scalar(1e-10)), Scalar(1));
}
template <class Scalar>
double our_ghost(double cosine, std::int64_t rays) {
    return ghost<Scalar>(cosine, rays, [](const Arrival<Scalar>& at) {
        const FresnelSplit<Scalar> split = fresnel_split<Scalar>(at.direction, at.normal, Scalar(1));
        return split.refracted == at.direction ? split.reflectance : Scalar(1);
    });
}

template <class Glass>
double time_glass(std::int64_t calls) {
    RandomInputs random(64);
    std::vector<Arrival<float>> arrivals;
    for (int i = 0; i < 256; ++i) arrivals.emplace_back(random, random.uniform(0, 0.999));
    double sum = 0;
    for (std::int64_t i = 0; i < calls; ++i) {
        const Arrival<float>& at = arrivals[static_cast<std::size_t>(i) % arrivals.size()];
        const FresnelSplit<float> split = Glass::template split<float>(at.direction, at.normal, 1 / 1.5F);
        sum += split.reflectance + split.refracted[0];
    }
    return sum;
}

}  // namespace

std::vector<Case> glass_cases() {
    const std::vector<double> cosines{0.99, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05};
    std::vector<Case> cases;
    cases.push_back(
        {.id = "head-on",
         .row = "4b",
         .parameter = "sine of the angle of arrival, at most",
         .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-8},
         .measure = "rays that become not-a-numbers, share",
         .tolerance = 0,
         .symptom = "black or white dots in the middle of glass spheres",
         .samples = 100'000,
         .methods = {{"cosine as it comes, float", Kind::Naive, head_on<float, Unclamped>, time_glass<Unclamped>},
                     {"ours, float", Kind::Ours, head_on<float, Ours>, time_glass<Ours>},
                     {"ours, double", Kind::Ours, head_on<double, Ours>}}});
    cases.push_back({.id = "critical-angle",
                     .row = "4c",
                     .parameter = "distance of the sine from the critical one, relative, at most",
                     .values = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7},
                     .measure = "rays that become not-a-numbers, share",
                     .tolerance = 0,
                     .symptom = "dots along the ring of total reflection",
                     .samples = 200'000,
                     .methods = {{"sine test and another root, float", Kind::Naive, critical_angle<float, Sine>},
                                 {"ours, float", Kind::Ours, critical_angle<float, Ours>},
                                 {"ours, double", Kind::Ours, critical_angle<double, Ours>}}});
    for (const bool is_leaving : {false, true}) {
        const double eta = is_leaving ? 1.5 : 1 / 1.5;
        cases.push_back({.id = is_leaving ? "reflectance-leaving" : "reflectance-entering",
                         .row = "4d",
                         .parameter = "cosine of the angle of arrival",
                         .values = cosines,
                         .measure = "reflectance, absolute error",
                         .tolerance = 2e-5,
                         .symptom = is_leaving ? "glass seen from inside does not mirror where it should"
                                               : "rims of glass are too dark or too bright by a few per cent",
                         .methods = {{"Schlick, float", Kind::Naive, reflectance_error_at<float, SchlickSplit>(eta)},
                                     {"ours, float", Kind::Ours, reflectance_error_at<float, OurSplit>(eta)},
                                     {"ours, double", Kind::Ours, reflectance_error_at<double, OurSplit>(eta)}}});
    }
    const auto schlick_ghost = [](double cosine, std::int64_t rays) {
        return ghost<float>(cosine, rays,
                            [](const Arrival<float>& at) { return naive::schlick<float>(cosine_of(at), 1.0F); });
    };
    const auto fresnel_ghost = [](double cosine, std::int64_t rays) {
        return ghost<float>(cosine, rays,
                            [](const Arrival<float>& at) { return naive::plain_fresnel<float>(cosine_of(at), 1.0F); });
    };
    cases.push_back({.id = "index-one",
                     .row = "4e",
                     .parameter = "cosine of the angle of arrival",
                     .values = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6},
                     .measure = "light reflected by glass that is not there, greatest share",
                     .tolerance = 0,
                     .symptom = "a sphere of air in air has a rim",
                     .samples = 20'000,
                     .methods = {{"Schlick, float", Kind::Naive, schlick_ghost},
                                 {"Fresnel without a rule for it, float", Kind::Naive, fresnel_ghost},
                                 {"ours, float", Kind::Ours, our_ghost<float>},
                                 {"ours, double", Kind::Ours, our_ghost<double>}}});
    return cases;
}

}  // namespace raypool::stability
