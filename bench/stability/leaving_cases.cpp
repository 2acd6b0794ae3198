// Rows 2a to 2d: rays that start on a surface, which they must neither meet again nor lose the other side of.

#include <cmath>

#include "bench/naive/spheres.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/shading/materials.h"

namespace raypool::stability {

namespace {

/// The same roots as ours, and hits closer than `least` do not count. `at` is a point of the surface.
struct NoEpsilon {
    template <class Scalar>
    static Scalar distance(const SurfacePoint<Scalar>& at, const Vec3<Scalar>& d, const Vec3<Scalar>& center, Scalar r,
                           bool) {
        return naive::haines_distance<Scalar>(at.position, d, center, r, Scalar(0));
    }
};
struct BookEpsilon {
    template <class Scalar>
    static Scalar distance(const SurfacePoint<Scalar>& at, const Vec3<Scalar>& d, const Vec3<Scalar>& center, Scalar r,
                           bool) {
        return naive::haines_distance<Scalar>(at.position, d, center, r, Scalar(naive::kBookEpsilon));
    }
};
/// The origin moved off the surface, to the side that the ray goes to.
struct Offset {
    template <class Scalar>
    static Scalar distance(const SurfacePoint<Scalar>& at, const Vec3<Scalar>& d, const Vec3<Scalar>& center, Scalar r,
                           bool) {
        const Vec3<Scalar> side = dot<Scalar>(d, at.outward) > 0 ? at.outward : Vec3<Scalar>(-at.outward);
        return naive::haines_distance<Scalar>(naive::offset_origin(at.position, side), d, center, r, Scalar(0));
    }
};
struct Ours {
    template <class Scalar>
    static Scalar distance(const SurfacePoint<Scalar>& at, const Vec3<Scalar>& d, const Vec3<Scalar>& center, Scalar r,
                           bool is_on) {
        return sphere_distance<Scalar>(at.position, d, center, r, is_on);
    }
};

template <class Scalar>
Vec3<Scalar> diffuse(RandomInputs& random, const Vec3<Scalar>& normal) {
    const auto [u, v] = random.unit_square<Scalar>();
    return diffuse_direction<Scalar>(normal, unit_sphere<Scalar>(u, v));
}

/// Diffuse rays that leave a sphere and meet it again, which none can.
template <class Scalar, class Test>
double acne(double radius, double translation, std::int64_t rays) {
    RandomInputs random(21);
    const auto r = static_cast<Scalar>(radius);
    std::int64_t met = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        const Vec3<Scalar> center = narrow<Scalar>(translation * random.direction<double>());
        const SurfacePoint<Scalar> point = seen_point<Scalar>(random, center, r);
        const Vec3<Scalar> direction = diffuse<Scalar>(random, point.normal);
        met += Test::template distance<Scalar>(point, direction, center, r, true) < kInfinity<Scalar> ? 1 : 0;
    }
    return share(met, rays);
}
template <class Scalar, class Test>
double acne_by_translation(double translation, std::int64_t rays) {
    return acne<Scalar, Test>(1, translation, rays);
}
template <class Scalar, class Test>
double acne_by_radius(double radius, std::int64_t rays) {
    return acne<Scalar, Test>(radius, 0, rays);
}

/// Rays refracted into a sphere of glass that do not meet its far side, which all do.
template <class Scalar, class Test>
double lost_far_side(double radius, std::int64_t rays) {
    RandomInputs random(22);
    const auto r = static_cast<Scalar>(radius);
    std::int64_t lost = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        const Vec3<Scalar> center = random.point<Scalar>(2);
        const SurfacePoint<Scalar> point = seen_point<Scalar>(random, center, r);
        Vec3<Scalar> arriving = random.direction<Scalar>();
        if (dot<Scalar>(arriving, point.normal) > 0) arriving = -arriving;
        const Vec3<Scalar> inward = fresnel_split<Scalar>(arriving, point.normal, 1 / Scalar(1.5)).refracted;
        lost += Test::template distance<Scalar>(point, inward, center, r, true) < kInfinity<Scalar> ? 0 : 1;
    }
    return share(lost, rays);
}

/// Light that comes through a sphere resting on the ground to the ground beneath it.
template <class Scalar, class Test>
double leak(double radius, std::int64_t rays) {
    RandomInputs random(23);
    const auto r = static_cast<Scalar>(radius);
    const Vec3<Scalar> center = vec3<Scalar>(0, r, 0);
    std::int64_t shadowed = 0;
    std::int64_t leaked = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        SurfacePoint<Scalar> ground{};
        ground.position = random.point<Scalar>(radius);
        ground.position[1] = 0;
        ground.normal = ground.outward = vec3<Scalar>(0, 1, 0);
        const Vec3<Scalar> up = diffuse<Scalar>(random, ground.normal);
        if (!ExactSphere(ground.position, up, center, r).is_met()) continue;
        ++shadowed;
        leaked += Test::template distance<Scalar>(ground, up, center, r, false) < kInfinity<Scalar> ? 0 : 1;
    }
    return share(leaked, shadowed);
}

/// A closed sphere whose wall shines with 1 and reflects 99 %: every path brings home 100. What is missing, as a part.
/// A path that leaves through the wall is lost; one that meets the wall where it stands is not seen, so this is a test
/// beside those for hits and never in their place.
template <class Scalar, class Test>
double furnace(double translation, std::int64_t paths) {
    constexpr double kAlbedo = 0.99;
    RandomInputs random(24);
    double sum = 0;
    for (std::int64_t i = 0; i < paths; ++i) {
        const Vec3<Scalar> center = narrow<Scalar>(translation * random.direction<double>());
        SurfacePoint<Scalar> point{};
        point.position = center;
        Vec3<Scalar> direction = random.direction<Scalar>();
        double throughput = 1;
        for (bool is_on = false; throughput > 1e-9; is_on = true) {
            const Scalar t = Test::template distance<Scalar>(point, direction, center, Scalar(1), is_on);
            if (!(t < kInfinity<Scalar>)) break;
            sum += throughput;
            throughput *= kAlbedo;
            point = sphere_point<Scalar>({point.position, direction, 0}, t, center, Scalar(1));
            direction = diffuse<Scalar>(random, point.normal);
        }
        if (throughput <= 1e-9) sum += throughput / (1 - kAlbedo);
    }
    return std::abs(sum * (1 - kAlbedo) / static_cast<double>(paths) - 1);
}

}  // namespace

std::vector<Case> leaving_cases() {
    std::vector<Case> cases;
    cases.push_back(
        {.id = "acne-far",
         .row = "2a",
         .parameter = "distance of the scene from the origin, radius 1",
         .values = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6},
         .measure = "diffuse rays that meet the sphere they leave, share",
         .tolerance = 0,
         .symptom = "acne: dark specks all over the surface",
         .samples = 200'000,
         .methods = {{"least distance 0, float", Kind::Naive, acne_by_translation<float, NoEpsilon>},
                     {"least distance 1e-3, float", Kind::Naive, acne_by_translation<float, BookEpsilon>},
                     {"offset origin, float", Kind::Alternative, acne_by_translation<float, Offset>},
                     {"ours, float", Kind::Ours, acne_by_translation<float, Ours>},
                     {"ours, double", Kind::Ours, acne_by_translation<double, Ours>}},
         .held = 6,
         .limit = "across the diameter float has 32 positions there, and the normal is not that of the rounded point"});
    cases.push_back({.id = "acne-large",
                     .row = "2a",
                     .parameter = "radius, at the origin",
                     .values = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5},
                     .measure = "diffuse rays that meet the sphere they leave, share",
                     .tolerance = 0,
                     .symptom = "acne on the ground",
                     .samples = 200'000,
                     .methods = {{"least distance 0, float", Kind::Naive, acne_by_radius<float, NoEpsilon>},
                                 {"least distance 1e-3, float", Kind::Naive, acne_by_radius<float, BookEpsilon>},
                                 {"offset origin, float", Kind::Alternative, acne_by_radius<float, Offset>},
                                 {"ours, float", Kind::Ours, acne_by_radius<float, Ours>},
                                 {"ours, double", Kind::Ours, acne_by_radius<double, Ours>}}});
    cases.push_back({.id = "far-side",
                     .row = "2b",
                     .parameter = "radius of a sphere of glass",
                     .values = {1e0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5},
                     .measure = "refracted rays that lose the far side, share",
                     .tolerance = 0,
                     .symptom = "small glass turns into a lens without a back",
                     .samples = 100'000,
                     .methods = {{"least distance 1e-3, float", Kind::Naive, lost_far_side<float, BookEpsilon>},
                                 {"ours, float", Kind::Ours, lost_far_side<float, Ours>},
                                 {"ours, double", Kind::Ours, lost_far_side<double, Ours>}}});
    cases.push_back({.id = "leak",
                     .row = "2c",
                     .parameter = "radius of a sphere on the ground",
                     .values = {1e0, 1e-1, 1e-2, 1e-3, 1e-4},
                     .measure = "rays from beneath that pass through it, share",
                     .tolerance = 0,
                     .symptom = "small things cast no shadow where they stand",
                     .samples = 20'000,
                     .methods = {{"least distance 1e-3, float", Kind::Naive, leak<float, BookEpsilon>},
                                 {"ours, float", Kind::Ours, leak<float, Ours>},
                                 {"ours, double", Kind::Ours, leak<double, Ours>}}});
    cases.push_back({.id = "furnace-far",
                     .row = "2d",
                     .parameter = "distance of the furnace from the origin, radius 1",
                     .values = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5},
                     .measure = "light of a closed furnace that is missing, part",
                     .tolerance = 2e-6,
                     .symptom = "closed rooms darken: light escapes through walls",
                     .samples = 300,
                     .methods = {{"least distance 1e-3, float", Kind::Naive, furnace<float, BookEpsilon>},
                                 {"ours, float", Kind::Ours, furnace<float, Ours>},
                                 {"ours, double", Kind::Ours, furnace<double, Ours>}}});
    return cases;
}

}  // namespace raypool::stability
