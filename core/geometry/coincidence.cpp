#include "core/geometry/coincidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/geometry/coincidence_bounds.h"
#include "core/geometry/nearby_keys.h"
#include "core/geometry/quad_index.h"
#include "core/geometry/shape_bounds.h"
#include "core/geometry/shapes.h"

namespace raypool {

namespace {

constexpr std::size_t kFewest = 16384;  ///< shapes that are worth more than one thread

/// Directions within the unit cube, at odds with axes and lattices.
const Vector3d kKeyA(0.8414709848, 0.4546487134, 0.9893582466);
const Vector3d kKeyB(0.6569865987, 0.2794154982, 0.7568024953);

template <class Scalar>
class Finder {
  public:
    explicit Finder(const Scene& scene) : scene_(scene), out_(no_coincidence(scene)), diagonal_(scene_diagonal(scene)) {
        for (const Quad& quad : scene.quads)
            described_.push_back(kDescribed * (quad.corner.norm() + quad.edge_u.norm() + quad.edge_v.norm()));
        for (const Plane& plane : scene.planes) described_.push_back(kDescribed * plane.point.norm());
    }

    Coincidence find() {
        hide_spheres();
        hide_planes();
        if (!scene_.quads.empty()) group_quads();
        return std::move(out_);
    }

  private:
    /// A sphere that is where an earlier one is, when the shutter opens and when it closes, is there at all times.
    void hide_spheres() {
        const auto center = [](const Sphere& s, double time) -> Vector3d {
            return s.center0 + time * (s.center1 - s.center0);
        };
        const double open = scene_.camera.shutter_open;
        const double close = scene_.camera.shutter_close;
        const auto coincide = [&](const Sphere& a, const Sphere& b) {
            const double bound = sphere_bound<Scalar>(a, b) - std::abs(a.radius - b.radius);
            return (center(a, open) - center(b, open)).norm() <= bound &&
                   (center(a, close) - center(b, close)).norm() <= bound;
        };
        // A difference of the bound in all numbers is one of less than 3 in the key, and the bounds of spheres that
        // coincide are nearly equal.
        std::vector<KeyWindow> keys(scene_.spheres.size());
#pragma omp parallel for schedule(static) if (keys.size() > kFewest)
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            const Sphere& sphere = scene_.spheres[i];
            keys[i] = {kKeyA.dot(center(sphere, open)) + kKeyB.dot(center(sphere, close)) + 0.5436 * sphere.radius,
                       4 * sphere_bound<Scalar>(sphere, sphere), i};
        }
        const std::vector<std::uint8_t> is_doubted = have_equal(
            keys, [&](std::uint32_t a, std::uint32_t b) { return coincide(scene_.spheres[a], scene_.spheres[b]); });
        NearbyKeys kept;
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            if (is_doubted[i] == 0) continue;
            if (kept.find(keys[i].key, keys[i].window,
                          [&](std::uint32_t k) { return coincide(scene_.spheres[k], scene_.spheres[i]); })) {
                out_.is_hidden[i] = true;
            } else {
                kept.add(keys[i].key, i);
            }
        }
    }

    /// Planes coincide where the bound holds at all points of both: their normals and one point each see to it.
    [[nodiscard]] bool planes_coincide(std::uint32_t plane_a, std::uint32_t plane_b) const {
        constexpr double u = kRoundoff<Scalar>;
        const Coincidence::Planar& a = out_.planars[scene_.quads.size() + plane_a];
        const Coincidence::Planar& b = out_.planars[scene_.quads.size() + plane_b];
        const Vector3d normal = a.normal.dot(b.normal) < 0 ? Vector3d(-b.normal) : b.normal;
        for (int i = 0; i < 3; ++i) {
            const double most = 5 * u * (std::abs(a.normal[i]) + std::abs(normal[i])) + 63 * u * u + kDescribed;
            if (!(std::abs(a.normal[i] - normal[i]) <= most)) return false;
        }
        return std::abs(a.normal.dot(b.point - a.point)) <=
               flat_bound<Scalar>(b.point, a.normal, a.point, b.point, diagonal_) +
                   described_[scene_.quads.size() + plane_a] + described_[scene_.quads.size() + plane_b];
    }

    void hide_planes() {
        const auto first_plane = static_cast<std::uint32_t>(scene_.quads.size());
        double described = 0;
        for (std::uint32_t i = 0; i < scene_.planes.size(); ++i)
            described = std::max(described, described_[first_plane + i]);
        NearbyKeys kept;
        for (std::uint32_t i = 0; i < scene_.planes.size(); ++i) {
            const Coincidence::Planar& planar = out_.planars[first_plane + i];
            const Vector3d& n = planar.normal;  // the key is the same for -n
            const double key = kKeyA.dot(planar.point) + kKeyB.dot(n.cwiseProduct(n)) +
                               kKeyA.dot(Vector3d(n[1] * n[2], n[2] * n[0], n[0] * n[1]));
            constexpr double u = kRoundoff<Scalar>;
            const double window = 200 * u * (1 + planar.point.norm() + u * diagonal_) + 10 * described;
            if (kept.find(key, window, [&](std::uint32_t k) { return planes_coincide(k, i); })) {
                out_.is_hidden[id(first_plane + i)] = true;
            } else {
                kept.add(key, i);
            }
        }
    }

    /// Whether all of a quad lies in the plane of normal n through `on_plane`, where that is also stored.
    [[nodiscard]] bool lies_in(const Vector3d& n, const Vector3d& on_plane, double plane_error,
                               std::uint32_t quad) const {
        bool is_in = true;
        for_each_corner(scene_.quads[quad], [&](const Vector3d& x) {
            if (!is_in) return;
            const double bound = flat_bound<Scalar>(x, n, on_plane, out_.planars[quad].point, diagonal_);
            is_in = std::abs(n.dot(x - on_plane)) <= bound + plane_error + described_[quad];
        });
        return is_in;
    }

    void share(std::uint32_t quad, const Vector3d& point, const Vector3d& normal, std::uint32_t group) {
        Coincidence::Planar& planar = out_.planars[quad];
        planar = {point, planar.normal.dot(normal) < 0 ? Vector3d(-normal) : normal, group};
    }

    /// Quads join a plane that they lie in or else, the largest first, the largest quad that they touch and whose plane
    /// they lie in, directly or over others that do: the larger shape has the more exact normal.
    void group_quads() {
        std::vector<Box> boxes(scene_.quads.size());
#pragma omp parallel for schedule(static) if (boxes.size() > kFewest)
        for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = quad_box<Scalar>(scene_.quads[i]);
        QuadIndex quads(std::move(boxes));

        constexpr double kFar = std::numeric_limits<double>::infinity();
        const Box everywhere{Vector3d::Constant(-kFar), Vector3d::Constant(kFar)};
        for (std::size_t i = 0; i < scene_.planes.size(); ++i) {
            const auto index = static_cast<std::uint32_t>(scene_.quads.size() + i);
            if (out_.is_hidden[id(index)]) continue;
            const Coincidence::Planar plane = out_.planars[index];
            quads.for_each_near(everywhere, plane.point, plane.normal, [&](std::uint32_t quad) {
                if (!lies_in(plane.normal, plane.point, described_[index], quad)) return;
                quads.take(quad);
                share(quad, plane.point, plane.normal, plane.group);
                if (static_cast<std::int64_t>(quad) >= scene_.planes[i].quads_before) out_.is_hidden[id(quad)] = true;
            });
        }

        std::vector<double> area;
        area.reserve(scene_.quads.size());
        for (const Quad& quad : scene_.quads) area.push_back(quad.edge_u.cross(quad.edge_v).norm());
        std::vector<std::uint32_t> by_area(scene_.quads.size());
        std::iota(by_area.begin(), by_area.end(), 0U);
        std::stable_sort(by_area.begin(), by_area.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return area[a] > area[b]; });
        const std::vector<std::uint8_t> is_joined = touch_in_plane(quads);
        for (const std::uint32_t first : by_area) {
            if (quads.is_taken(first)) continue;
            if (is_joined[first] != 0) {
                group_from(first, quads);
            } else {
                quads.take(first);
            }
        }
    }

    /// By quad not taken, 1 where another one that it touches lies in its plane: no other quad begins a group.
    [[nodiscard]] std::vector<std::uint8_t> touch_in_plane(const QuadIndex& quads) const {
        std::vector<std::uint8_t> is_joined(scene_.quads.size());
#pragma omp parallel for schedule(dynamic, 1024) if (is_joined.size() > kFewest)
        for (const std::uint32_t i : quads.by_place()) {
            if (quads.is_taken(i)) continue;
            const Coincidence::Planar& plane = out_.planars[i];
            is_joined[i] = quads.has_near(quads.box(i), plane.point, plane.normal, [&](std::uint32_t other) {
                return other != i && lies_in(plane.normal, plane.point, described_[i], other);
            });
        }
        return is_joined;
    }

    void group_from(std::uint32_t first, QuadIndex& quads) {
        const Coincidence::Planar plane = out_.planars[first];
        const auto onto_plane = [&](const Vector3d& x) -> Vector3d {
            return x - plane.normal.dot(x - plane.point) * plane.normal;
        };
        quads.take(first);
        std::vector<std::uint32_t> members{first};
        Vector3d nearest = plane.point;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const std::uint32_t member = members[i];
            const Vector3d point = i == 0 ? plane.point : onto_plane(out_.planars[member].point);
            if (point.norm() < nearest.norm()) nearest = point;
            quads.for_each_near(quads.box(member), plane.point, plane.normal, [&](std::uint32_t quad) {
                if (!lies_in(plane.normal, point, described_[first], quad)) return;
                quads.take(quad);
                members.push_back(quad);
            });
        }
        if (members.size() == 1) return;
        for (const std::uint32_t member : members) share(member, nearest, plane.normal, plane.group);
        hide_covered(members);
    }

    /// Of quads in one plane, those that a single one listed before covers.
    void hide_covered(const std::vector<std::uint32_t>& members) {
        std::vector<Box> boxes;
        boxes.reserve(members.size());
        for (const std::uint32_t member : members) boxes.push_back(quad_box<Scalar>(scene_.quads[member]));
        QuadIndex quads(std::move(boxes));
        for (std::uint32_t i = 0; i < members.size(); ++i) {
            const std::uint32_t quad = members[i];
            quads.for_each_near(quads.box(i), out_.planars[quad].point, out_.planars[quad].normal,
                                [&](std::uint32_t k) {
                                    if (members[k] < quad && covers(members[k], quad)) out_.is_hidden[id(quad)] = true;
                                });
        }
    }

    /// Whether the corners of a quad are on another one, in whose plane it lies.
    [[nodiscard]] bool covers(std::uint32_t cover, std::uint32_t under) const {
        const PlanarShape planar = planar_shape(scene_.quads[cover]);
        bool is_covered = true;
        for_each_corner(scene_.quads[under], [&](const Vector3d& x) {
            for (const Vector3d& dual : {planar.dual_u, planar.dual_v}) {
                const double at = dual.dot(x - planar.corner);
                const double slack = kEdgeSlack<Scalar> + dual.norm() * (described_[cover] + described_[under]);
                is_covered = is_covered && at >= -slack && at <= 1 + slack;
            }
        });
        return is_covered;
    }

    [[nodiscard]] std::size_t id(std::size_t planar) const {
        return scene_.spheres.size() + planar;
    }

    const Scene& scene_;
    Coincidence out_;
    double diagonal_;
    std::vector<double> described_;  ///< by flat shape: how far off its plane its own description may be
};

}  // namespace

Coincidence no_coincidence(const Scene& scene) {
    Coincidence out;
    const auto add = [&](const PlanarShape& shape) {
        const auto id = static_cast<std::uint32_t>(scene.spheres.size() + out.planars.size());
        out.planars.push_back({shape.point, shape.normal, id});
    };
    for (const Quad& quad : scene.quads) add(planar_shape(quad));
    for (const Plane& plane : scene.planes) add(planar_shape(plane));
    out.is_hidden.resize(scene.spheres.size() + out.planars.size());
    return out;
}

template <class Scalar>
Coincidence find_coincidence(const Scene& scene) {
    return Finder<Scalar>(scene).find();
}

template Coincidence find_coincidence<float>(const Scene&);
template Coincidence find_coincidence<double>(const Scene&);

}  // namespace raypool
