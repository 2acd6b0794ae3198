// Row 3d: shapes that move while the shutter is open, and those that do not.

#include <algorithm>

#include "bench/stability/case.h"
#include "bench/stability/padded.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

// Ways to find where a coordinate is at a time, between two ends.
/// As one would write it at first: exact at both ends, but it moves a sphere that stands still.
constexpr auto kBlend = []<class Scalar>(Scalar a, Scalar b, Scalar time) { return (1 - time) * a + time * b; };
constexpr auto kOurs = []<class Scalar>(Scalar a, Scalar b, Scalar time) {
    return center_at<Scalar>(vec3<Scalar>(a, a, a), Vec3<Scalar>::Constant(b - a), time)[0];
};

/// Coordinates that do not move, and do.
constexpr auto kMoved = []<class Scalar>(const auto& at, double magnitude, std::int64_t times) {
    return share_of(times, RandomInputs(41), [&](RandomInputs& random) {
        const auto a = static_cast<Scalar>(random.uniform(-magnitude, magnitude));
        return at(a, a, random.unit_interval<Scalar>()) != a;
    });
};

/// Where a coordinate is at a time just before the shutter closes, against the exact place between the two ends as they
/// are stored; relative to the greater.
constexpr auto kEndError = []<class Scalar>(const auto& at, double before_end, std::int64_t times) {
    const auto time = static_cast<Scalar>(1 - before_end);
    const auto judge = [&](RandomInputs& random, Errors& errors) {
        const auto a = static_cast<Scalar>(random.uniform(-1, 1));
        const auto b = static_cast<Scalar>(random.uniform(-1, 1));
        const Float128 exact = Float128{a} + Float128{time} * (Float128{b} - Float128{a});
        errors.add((at(a, b, time) - exact) / std::max(std::abs(a), std::abs(b)));
    };
    return errors_of(times, RandomInputs(42), judge).max();
};

// Whether a sphere, with that centre now, reaches out of a box along an axis.
/// The box is between those of both ends.
constexpr auto kLeavesBlended = []<class Scalar>(const PaddedSphere<Scalar>& s, Scalar center, int axis, Scalar time) {
    const Scalar end = s.center[axis] + s.motion[axis];
    const Scalar low = kBlend(s.center[axis] - s.radius, end - s.radius, time);
    const Scalar high = kBlend(s.center[axis] + s.radius, end + s.radius, time);
    return Float128{center} - s.radius < low || Float128{center} + s.radius > high;
};
/// The box is ours: the sphere must be in that over the whole shutter, and its own padded box, as kernels round it, in
/// that at the time.
constexpr auto kLeavesOurs = []<class Scalar>(const PaddedSphere<Scalar>& s, Scalar center, int axis, Scalar time) {
    return Float128{center} - s.radius < s.leaf.bounds[0][axis] ||
           Float128{center} + s.radius > s.leaf.bounds[1][axis] ||
           center - s.padded_radius < s.leaf.at(0, axis, time) || center + s.padded_radius > s.leaf.at(1, axis, time);
};
/// Moving spheres that reach out of their box.
constexpr auto kOutside = []<class Scalar>(const auto& leaves, double translation, std::int64_t times) {
    RandomInputs inputs(43);
    std::vector<Sphere> spheres(static_cast<std::size_t>(std::max<std::int64_t>(times / 20, 200)));
    for (Sphere& sphere : spheres) {
        sphere.center0 = wide<Scalar>(inputs.point<Scalar>(translation));
        sphere.center1 = sphere.center0 + inputs.point<double>(1);
        sphere.radius = inputs.uniform(0.001, 0.1) * translation;
    }
    const std::vector<PaddedSphere<Scalar>> padded = padded_spheres<Scalar>(spheres);
    return share_of(times, inputs, [&](RandomInputs& random) {
        const PaddedSphere<Scalar>& s = any_of(padded, random);
        const Scalar time = random.unit_interval<Scalar>();
        const Vec3<Scalar> center = center_at<Scalar>(s.center, s.motion, time);
        return leaves(s, center[0], 0, time) || leaves(s, center[1], 1, time) || leaves(s, center[2], 2, time);
    });
};

}  // namespace

CaseMethods motion_cases() {
    return {{"still-sphere", Methods(kMoved).naive("(1 - t) a + t b, float", kBlend).ours_in_both(kOurs)},
            {"moving-box",
             Methods(kOutside).naive("box between two boxes, float", kLeavesBlended).ours_in_both(kLeavesOurs)},
            {"motion-end", Methods(kEndError).other("(1 - t) a + t b, float", kBlend).ours_in_both(kOurs)}};
}

}  // namespace raypool::stability
