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
constexpr auto kFloatScale = static_cast<float>(kScale);

template <class Scalar>
TwoParts<Scalar> split_scale() {
    const auto high = static_cast<Scalar>(kScale);
    return {high, static_cast<Scalar>(kScale - static_cast<double>(high))};
}
// Ways to tell whether the cell of a coordinate is odd.
constexpr auto kTruncated = []<class Real>(const Real& x) {
    return naive::truncated_parity<Real>(x, Real(kFloatScale));
};
constexpr auto kFloored = []<class Real>(const Real& x) { return naive::floored_parity<Real>(x, Real(kFloatScale)); };
constexpr auto kOurs = []<class Real>(const Real& x) {
    const auto scale = split_scale<ScalarOf<Real>>();
    return cell_parity<Real>(x, {Real(scale.high), Real(scale.low)});
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
auto wrong_cells(double sign) {
    return [sign]<class Scalar>(const auto& parity, double magnitude, std::int64_t points) {
        return share_of(points, RandomInputs(81), [&](RandomInputs& random) {
            const auto x = static_cast<Scalar>(sign * random.uniform(0.5 * magnitude, magnitude));
            return (parity(x) != 0) != is_odd_exactly(static_cast<double>(x));
        });
    };
}

/// Points of the plane y = 0 as rays from a height meet it: those whose colour is not that of the plane's cells above.
constexpr auto kPlaneFlips = []<class>(const auto& is_odd, double height, std::int64_t rays) {
    const Vec3<float> normal = vec3<float>(0, 1, 0);
    return share_of(rays, RandomInputs(82), [&](RandomInputs& random) {
        const Vec3<double> eye(random.uniform(-1, 1), height * random.uniform(0.5, 1), random.uniform(-1, 1));
        Vec3<double> target = random.point<double>(10);
        target[1] = 0;
        const Vec3<float> origin = narrow<float>(eye);
        const Vec3<float> direction = narrow<float>((target - eye).normalized());
        const float t = plane_distance<float>(origin, direction, vec3<float>(0, 0, 0), normal, false);
        const Vec3<float> p = along<float>(origin, t, direction);
        return is_odd(p) != is_odd(vec3<float>(p[0], 0, p[2]));
    });
};
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

template <class Parity>
auto timed(Parity parity) {
    return [parity](std::int64_t calls) {
        Packet sum(0);
        for (std::int64_t i = 0; i < calls / kLanes<Packet>; ++i)
            sum += parity(Packet(static_cast<float>(i % 4096) - 2048.3F));
        return static_cast<double>(lane(sum, 0));
    };
}

}  // namespace

CaseMethods texture_cases() {
    return {{"checker", Methods(wrong_cells(1))
                            .other("(int) truncation, float", kTruncated, timed(kTruncated))
                            .naive("floor, float", kFloored, timed(kFloored))
                            .ours_in_both(kOurs, timed(kOurs))},
            {"checker-below-zero", Methods(wrong_cells(-1))
                                       .naive("(int) truncation, float", kTruncated)
                                       .naive("floor, float", kFloored)
                                       .ours_in_both(kOurs)},
            {"checker-in-plane", Methods(kPlaneFlips)
                                     .naive("3-D checker, y = 0 a boundary", is_odd_in_space)
                                     .ours("ours, put back and on the outward side", is_odd_above)
                                     .ours("ours, moved by half a cell (offset)", is_odd_moved)
                                     .ours("ours, surface (u, v)", is_odd_in_plane)}};
}

}  // namespace raypool::stability
