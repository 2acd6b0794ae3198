// Row 2f: shapes that are one surface. What leaves one of them must not meet the other.

#include <cmath>

#include <Eigen/Geometry>

#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/geometry/coincidence.h"
#include "core/geometry/traverse.h"

namespace raypool::stability {

namespace {

/// A place, and two directions across and one along the normal of the surface there.
struct Place {
    Vector3d at, u, v, n;
};
Place random_place(RandomInputs& random, double distance) {
    const Vector3d n = random.direction<double>();
    const Vector3d u = perpendicular(random, n);
    return {distance * random.direction<double>(), u, n.cross(u), n};
}

// Each lists the surface at the place in one shape, or in two.
void add_plane_and_quad(Scene& scene, const Place& p, bool is_twice) {
    scene.quads.push_back({p.at - 10 * p.u - 10 * p.v, 20 * p.u, 20 * p.v, 0});
    if (is_twice) scene.planes.push_back({p.at + 3 * p.u - 7 * p.v, p.n, 0});
}
void add_quads(Scene& scene, const Place& p, bool is_twice) {
    scene.quads.push_back({p.at - 10 * p.u - 10 * p.v, 20 * p.u, 20 * p.v, 0});
    if (is_twice) scene.quads.push_back({p.at + 12 * p.u, -11 * p.u + 12 * p.v, -12 * p.u - 13 * p.v, 0});
}
void add_spheres(Scene& scene, const Place& p, bool is_twice) {
    for (int i = 0; i < (is_twice ? 2 : 1); ++i) scene.spheres.push_back({p.at, p.at, 5, 0});
}
void add_glass(Scene& scene, const Place& p, bool is_twice) {
    add_spheres(scene, p, is_twice);
    scene.materials[0] = {.kind = Material::Kind::Dielectric, .ior = 1.5};
}
/// One at rest, and one that moves by less than rounding tells.
void add_moving(Scene& scene, const Place& p, bool is_twice) {
    add_spheres(scene, p, is_twice);
    if (is_twice) scene.spheres[1].center1 += 1e-17 * p.u;
}

/// Hits of a path on its way, at most so many.
template <class Scalar>
int hit_count(const CompiledScene<Scalar>& scene, Ray<Scalar> ray, std::uint32_t path) {
    constexpr int kMost = 12;
    auto leaving = std::int32_t{kNoPrimitive};
    NoTestCount work;
    for (int hits = 0; hits < kMost; ++hits) {
        const Hit<Scalar> hit = closest_hit<kEverything>(scene, ray, leaving, work);
        if (hit.primitive_id == kNoPrimitive) return hits;
        const Scattered<Scalar> out =
            scatter<kEverything, Scalar>(scene, ray, hit.t, hit.primitive_id, vec3<Scalar>(1, 1, 1), {path, 0},
                                         static_cast<std::uint32_t>(hits), random_seed(0));
        ray.origin = out.start.origin;
        ray.direction = out.direction;
        leaving = static_cast<std::int32_t>(out.start.leaving_id);
    }
    return kMost;
}

constexpr auto kOurs = []<class Scalar>(const Scene& scene) { return compile<Scalar>(scene); };
constexpr auto kIdAlone = []<class Scalar>(const Scene& scene) {
    return compile<Scalar>(scene, no_coincidence(scene));
};

/// Paths that meet a surface listed twice more or less often than the surface listed once.
std::vector<Method> methods(void (*list)(Scene& scene, const Place& place, bool is_twice)) {
    const auto changed_paths = [list]<class Scalar>(const auto& compile_twice, double distance, std::int64_t paths) {
        constexpr int kPathsOfPlace = 20;
        RandomInputs random(25);
        std::int64_t changed = 0;
        std::int64_t traced = 0;
        while (traced < paths) {
            const Place place = random_place(random, distance);
            Scene once;
            once.camera.look_from = place.at + 10 * place.n;
            once.camera.shutter_close = 1;
            once.textures.emplace_back().even = Vector3d::Constant(0.8);
            once.materials.emplace_back();
            Scene twice = once;
            list(once, place, false);
            list(twice, place, true);
            const CompiledScene<Scalar> first = compile<Scalar>(once);
            const CompiledScene<Scalar> both = compile_twice.template operator()<Scalar>(twice);
            for (int i = 0; i < kPathsOfPlace; ++i, ++traced) {
                const Vector3d target =
                    place.at + random.uniform(-0.5, 0.5) * place.u + random.uniform(-0.5, 0.5) * place.v;
                Vector3d away = random.direction<double>();
                if (away.dot(place.n) < 0) away = -away;
                away = (away + 0.2 * place.n).normalized();
                const Ray<Scalar> ray{narrow<Scalar>(target + 10 * away), narrow<Scalar>(-away),
                                      random.unit_interval<Scalar>()};
                const auto path = static_cast<std::uint32_t>(traced);
                changed += hit_count<Scalar>(first, ray, path) != hit_count<Scalar>(both, ray, path) ? 1 : 0;
            }
        }
        return share(changed, traced);
    };
    return Methods(changed_paths)
        .naive("excluding the id alone, float", kIdAlone)
        .naive<double>("excluding the id alone, double", kIdAlone)
        .ours_in_both(kOurs);
}

}  // namespace

CaseMethods coincidence_cases() {
    return {{"coincident-plane-quad", methods(add_plane_and_quad)},
            {"coincident-quads", methods(add_quads)},
            {"coincident-spheres", methods(add_spheres)},
            {"coincident-glass", methods(add_glass)},
            {"coincident-moving", methods(add_moving)}};
}

}  // namespace raypool::stability
