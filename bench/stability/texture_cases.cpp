// Rows 8a and 8b: checkers far from the origin, below zero, and in the plane between two layers of cells.

#include <cmath>
#include <numbers>

#include "bench/naive/checkers.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/shading/textures.h"

namespace raypool::stability {

namespace {

/// Of cells whose edges no float lies on: where one does, the last bit of the scale decides, and no method is wrong.
constexpr double kScale = std::numbers::pi;

template <class Scalar>
TwoParts<Scalar> split_scale() {
    const auto high = static_cast<Scalar>(kScale);
    return {high, static_cast<Scalar>(kScale - static_cast<double>(high))};
}
struct Truncated {
    template <class Scalar>
    static Scalar parity(Scalar x) {
        return naive::truncated_parity<Scalar>(x, static_cast<Scalar>(kScale));
    }
};
struct Floored {
    template <class Scalar>
    static Scalar parity(Scalar x) {
        return naive::floored_parity<Scalar>(x, static_cast<Scalar>(kScale));
    }
};
struct Ours {
    template <class Scalar>
    static Scalar parity(Scalar x) {
        return cell_parity<Scalar>(x, split_scale<Scalar>());
    }
};

/// Whether the whole number below x times the scale, as a double has it, is odd.
bool is_odd_exactly(double x) {
    constexpr Float128 kHigh = kScale;
    const Float128 scaled = Float128{x} * kHigh;
    auto below = static_cast<std::int64_t>(scaled);
    if (Float128(below) > scaled) --below;
    return (below & 1) != 0;
}

/// Coordinates of that magnitude, of one sign: those whose cell has the wrong colour.
template <class Scalar, class Checker>
double wrong_cells(double magnitude, std::int64_t points, double sign) {
    RandomInputs random(81);
    std::int64_t wrong = 0;
    for (std::int64_t i = 0; i < points; ++i) {
        const auto x = static_cast<Scalar>(sign * random.uniform(0.5 * magnitude, magnitude));
        const bool is_odd = Checker::template parity<Scalar>(x) != 0;
        wrong += is_odd != is_odd_exactly(static_cast<double>(x)) ? 1 : 0;
    }
    return share(wrong, points);
}
template <class Scalar, class Checker>
auto wrong_cells_of(double sign) {
    return
        [sign](double magnitude, std::int64_t points) { return wrong_cells<Scalar, Checker>(magnitude, points, sign); };
}

/// Points of the plane y = 0 as rays from a height meet it: those whose colour is not that of the plane's cells above.
template <class IsOdd>
double plane_flips(double height, std::int64_t rays, IsOdd is_odd) {
    RandomInputs random(82);
    const Vec3<float> normal = vec3<float>(0, 1, 0);
    std::int64_t flips = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        const Vec3<double> eye(random.uniform(-1, 1), height * random.uniform(0.5, 1), random.uniform(-1, 1));
        Vec3<double> target = random.point<double>(10);
        target[1] = 0;
        const Vec3<float> origin = narrow<float>(eye);
        const Vec3<float> direction = narrow<float>((target - eye).normalized());
        const float t = plane_distance<float>(origin, direction, vec3<float>(0, 0, 0), normal, false);
        const Vec3<float> p = along<float>(origin, t, direction);
        flips += is_odd(p) != is_odd(vec3<float>(p[0], 0, p[2])) ? 1 : 0;
    }
    return share(flips, rays);
}
bool is_odd_in_space(const Vec3<float>& p) {
    return is_odd_cell<float>(p, vec3<float>(0, 0, 0), split_scale<float>());
}
/// On the side of the surface that looks up.
bool is_odd_above(const Vec3<float>& p) {
    const float up = outward_part<float>(p[1], 0, split_scale<float>(), 1);
    return is_odd_cell<float>(vec3<float>(p[0], 0, p[2]), vec3<float>(0, up, 0), split_scale<float>());
}
bool is_odd_moved(const Vec3<float>& p) {
    const Vec3<float> moved = vec3<float>(p[0], p[1] + 0.5F / static_cast<float>(kScale), p[2]);
    return is_odd_cell<float>(moved, vec3<float>(0, 0, 0), split_scale<float>());
}
bool is_odd_in_plane(const Vec3<float>& p) {
    const auto [u, v] = plane_coordinates<float>(p, vec3<float>(0, 0, 0), vec3<float>(1, 0, 0), vec3<float>(0, 0, 1));
    return is_odd_cell<float>(vec3<float>(u, v, 0), vec3<float>(0, 0, 0), split_scale<float>());
}

template <class Checker>
double time_checker(std::int64_t calls) {
    Packet sum(0);
    constexpr int kLanesOf = kLanes<Packet>;
    for (std::int64_t i = 0; i < calls / kLanesOf; ++i) {
        const Packet x(static_cast<float>(i % 4096) - 2048.3F);
        if constexpr (std::same_as<Checker, Ours>) {
            const TwoParts<float> scale = split_scale<float>();
            sum += cell_parity<Packet>(x, {Packet(scale.high), Packet(scale.low)});
        } else if constexpr (std::same_as<Checker, Floored>) {
            sum += naive::floored_parity<Packet>(x, Packet(static_cast<float>(kScale)));
        } else {
            sum += naive::truncated_parity<Packet>(x, Packet(static_cast<float>(kScale)));
        }
    }
    return static_cast<double>(lane(sum, 0));
}

}  // namespace

std::vector<Case> texture_cases() {
    const std::vector<double> magnitudes{1e1, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
    std::vector<Case> cases;
    for (const double sign : {1.0, -1.0}) {
        std::vector<Method> methods{{"(int) truncation, float", sign < 0 ? Kind::Naive : Kind::Alternative,
                                     wrong_cells_of<float, Truncated>(sign)},
                                    {"floor, float", Kind::Naive, wrong_cells_of<float, Floored>(sign)},
                                    {"ours, float", Kind::Ours, wrong_cells_of<float, Ours>(sign)},
                                    {"ours, double", Kind::Ours, wrong_cells_of<double, Ours>(sign)}};
        if (sign > 0) {
            methods[0].work = time_checker<Truncated>;
            methods[1].work = time_checker<Floored>;
            methods[2].work = time_checker<Ours>;
        }
        cases.push_back({.id = sign > 0 ? "checker" : "checker-below-zero",
                         .row = "8a",
                         .parameter = sign > 0 ? "coordinate" : "coordinate below zero",
                         .values = magnitudes,
                         .measure = "cells of the wrong colour, share",
                         .tolerance = 0,
                         .symptom = sign > 0 ? "checkers fray, then turn to noise"
                                             : "a double cell at zero, and all colours beyond it swapped",
                         .samples = 100'000,
                         .methods = std::move(methods),
                         .held = 7,
                         .limit = "in float, the scale has 48 bits"});
    }
    const auto flips_of = [](bool (*is_odd)(const Vec3<float>&)) {
        return [is_odd](double height, std::int64_t rays) { return plane_flips(height, rays, is_odd); };
    };
    cases.push_back({.id = "checker-in-plane",
                     .row = "8b",
                     .parameter = "height of the camera",
                     .values = {1e-1, 1e0, 1e1, 1e2, 1e3},
                     .measure = "points of y = 0 with another colour than y = +0, share",
                     .tolerance = 1e-4,
                     .symptom = "noise of both colours all over the floor",
                     .samples = 50'000,
                     .methods = {{"3-D checker, y = 0 a boundary", Kind::Naive, flips_of(is_odd_in_space)},
                                 {"ours, put back and on the outward side", Kind::Ours, flips_of(is_odd_above)},
                                 {"ours, moved by half a cell (offset)", Kind::Ours, flips_of(is_odd_moved)},
                                 {"ours, surface (u, v)", Kind::Ours, flips_of(is_odd_in_plane)}}});
    return cases;
}

}  // namespace raypool::stability
