// Row 3d: shapes that move while the shutter is open, and those that do not.

#include <algorithm>

#include "bench/naive/motion.h"
#include "bench/stability/case.h"
#include "bench/stability/padded.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

struct Blend {
    template <class Scalar>
    static Scalar at(Scalar a, Scalar b, Scalar time) {
        return naive::blend<Scalar>(a, b, time);
    }
};
struct Ours {
    template <class Scalar>
    static Scalar at(Scalar a, Scalar b, Scalar time) {
        return center_at<Scalar>(vec3<Scalar>(a, a, a), Vec3<Scalar>::Constant(b - a), time)[0];
    }
};

/// Coordinates that do not move, and do.
template <class Scalar, class Motion>
double moved(double magnitude, std::int64_t times) {
    RandomInputs random(41);
    std::int64_t wrong = 0;
    for (std::int64_t i = 0; i < times; ++i) {
        const auto a = static_cast<Scalar>(random.uniform(-magnitude, magnitude));
        wrong += Motion::template at<Scalar>(a, a, random.unit_interval<Scalar>()) != a ? 1 : 0;
    }
    return share(wrong, times);
}

/// Where a coordinate is at a time just before the shutter closes, against the exact place between the two ends as they
/// are stored; relative to the greater.
template <class Scalar, class Motion>
double end_error(double before_end, std::int64_t times) {
    RandomInputs random(42);
    Errors errors;
    const auto time = static_cast<Scalar>(1 - before_end);
    for (std::int64_t i = 0; i < times; ++i) {
        const auto a = static_cast<Scalar>(random.uniform(-1, 1));
        const auto b = static_cast<Scalar>(random.uniform(-1, 1));
        const Float128 exact = Float128{a} + Float128{time} * (Float128{b} - Float128{a});
        errors.add((Motion::template at<Scalar>(a, b, time) - exact) / std::max(std::abs(a), std::abs(b)));
    }
    return errors.max();
}

/// Moving spheres that reach out of the box that is kept for them: of the box between the boxes of both ends, or of one
/// of ours, over the whole shutter and at the time.
template <class Scalar>
std::vector<PaddedSphere<Scalar>> moving_spheres(RandomInputs& random, double translation, std::int64_t count) {
    std::vector<Sphere> spheres(static_cast<std::size_t>(std::max<std::int64_t>(count / 20, 200)));
    for (Sphere& sphere : spheres) {
        sphere.center0 = wide<Scalar>(random.point<Scalar>(translation));
        sphere.center1 = sphere.center0 + random.point<double>(1);
        sphere.radius = random.uniform(0.001, 0.1) * translation;
    }
    return padded_spheres<Scalar>(spheres);
}
template <class Scalar>
double blended_box(double translation, std::int64_t times) {
    RandomInputs random(43);
    const auto spheres = moving_spheres<Scalar>(random, translation, times);
    std::int64_t outside = 0;
    for (std::int64_t i = 0; i < times; ++i) {
        const PaddedSphere<Scalar>& s =
            spheres[static_cast<std::size_t>(random.below(static_cast<int>(spheres.size())))];
        const Scalar time = random.unit_interval<Scalar>();
        const Vec3<Scalar> center = center_at<Scalar>(s.center, s.motion, time);
        bool is_outside = false;
        for (int k = 0; k < 3; ++k) {
            const Scalar end = s.center[k] + s.motion[k];
            const Scalar low = naive::blend<Scalar>(s.center[k] - s.radius, end - s.radius, time);
            const Scalar high = naive::blend<Scalar>(s.center[k] + s.radius, end + s.radius, time);
            is_outside = is_outside || Float128{center[k]} - s.radius < low || Float128{center[k]} + s.radius > high;
        }
        outside += is_outside ? 1 : 0;
    }
    return share(outside, times);
}
template <class Scalar>
double our_boxes(double translation, std::int64_t times) {
    RandomInputs random(43);
    const auto spheres = moving_spheres<Scalar>(random, translation, times);
    std::int64_t outside = 0;
    for (std::int64_t i = 0; i < times; ++i) {
        const PaddedSphere<Scalar>& s =
            spheres[static_cast<std::size_t>(random.below(static_cast<int>(spheres.size())))];
        const Scalar time = random.unit_interval<Scalar>();
        const Vec3<Scalar> center = center_at<Scalar>(s.center, s.motion, time);
        bool is_outside = false;
        for (int k = 0; k < 3; ++k) {
            const Float128 low = Float128{center[k]} - s.radius;
            const Float128 high = Float128{center[k]} + s.radius;
            is_outside = is_outside || low < s.leaf.bounds[0][k] || high > s.leaf.bounds[1][k];
            // Its own padded box, as kernels round it, must be inside too.
            is_outside = is_outside || center[k] - s.padded_radius < s.leaf.at(0, k, time) ||
                         center[k] + s.padded_radius > s.leaf.at(1, k, time);
        }
        outside += is_outside ? 1 : 0;
    }
    return share(outside, times);
}

}  // namespace

std::vector<Case> motion_cases() {
    std::vector<Case> cases;
    cases.push_back({.id = "still-sphere",
                     .row = "3d",
                     .parameter = "distance from the origin",
                     .values = {1e0, 1e1, 1e2, 1e3, 1e4},
                     .measure = "times at which a still centre moves, share",
                     .tolerance = 0,
                     .symptom = "a scene changes when the code for motion is compiled in",
                     .samples = 200'000,
                     .methods = {{"(1 - t) a + t b, float", Kind::Naive, moved<float, Blend>},
                                 {"ours, float", Kind::Ours, moved<float, Ours>},
                                 {"ours, double", Kind::Ours, moved<double, Ours>}}});
    cases.push_back({.id = "moving-box",
                     .row = "3d",
                     .parameter = "distance from the origin",
                     .values = {1e0, 1e1, 1e2, 1e3, 1e4},
                     .measure = "times at which a sphere is not in its box, share",
                     .tolerance = 0,
                     .symptom = "moving spheres flicker at their edges",
                     .samples = 100'000,
                     .methods = {{"box between two boxes, float", Kind::Naive, blended_box<float>},
                                 {"ours, float", Kind::Ours, our_boxes<float>},
                                 {"ours, double", Kind::Ours, our_boxes<double>}}});
    cases.push_back({.id = "motion-end",
                     .row = "+",
                     .parameter = "1 - time",
                     .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0},
                     .measure = "place of the centre, greatest relative error",
                     .tolerance = 2.5e-7,
                     .symptom = "none: both ways are within rounding of the end",
                     .samples = 50'000,
                     .methods = {{"(1 - t) a + t b, float", Kind::Alternative, end_error<float, Blend>},
                                 {"ours, float", Kind::Ours, end_error<float, Ours>},
                                 {"ours, double", Kind::Ours, end_error<double, Ours>}}});
    return cases;
}

}  // namespace raypool::stability
