/// One ray at a time or a register of rays at a time: every kernel gives the same bits. Scattering in scenes is in
/// scatter_agreement_test.cpp, the operations that kernels are made of in real_test.cpp.
#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "core/shading/camera.h"
#include "core/shading/materials.h"
#include "core/shading/shade.h"
#include "core/shading/textures.h"
#include "tests/core/math/lane_agreement.h"

namespace raypool::test {
namespace {

/// A unit vector perpendicular to `n`.
template <class S>
Vec3<S> perpendicular(const Vec3<S>& n) {
    return std::abs(n[0]) < S(0.5) ? unit<S>(vec3<S>(0, -n[2], n[1])) : unit<S>(vec3<S>(-n[2], 0, n[0]));
}
/// Along an axis; the zeros have either sign.
template <class S>
Vec3<S> axis_direction(RandomInputs& random) {
    Vec3<S> d = random.lattice_point<S>(0);
    const int axis = random.below(3);
    d[axis] = random.one_in(2) ? 1 : -1;
    return d;
}

TEST(KernelAgreement, VectorsOperations) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const bool is_tame = random.one_in(2);
        for (int i = 0; i < 7; ++i) row.real(is_tame ? random.magnitude<S>(-8, 8) : random.any<S>());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Vec3<Real> a = in.vec();
        const Vec3<Real> b = in.vec();
        const Real t = in.real();
        out(dot<Real>(a, b)), out(along<Real>(a, t, b)), out(unit<Real>(a)), out(center_at<Real>(a, b, t));
        out(select<Real>(t > Real(0), a, b));
    });
}

/// Spheres of every size, some grazed by the ray, some around its origin, some exactly touched in whole numbers.
constexpr auto kRayAndSphere = []<class S>(RandomInputs& random, Row<S>& row) {
    Vec3<S> origin = random.point<S>(10);
    Vec3<S> direction = random.direction<S>();
    Vec3<S> center = random.point<S>(10);
    S radius = static_cast<S>(random.uniform(0.05, 5));
    switch (random.below(4)) {
        case 0:  // grazing
            origin =
                along<S>(along<S>(center, radius, perpendicular<S>(direction)), S(random.uniform(-20, 5)), direction);
            break;
        case 1:  // on the surface
            origin = along<S>(center, radius, random.direction<S>());
            break;
        case 2:
            origin = random.lattice_point<S>(4);
            center = random.lattice_point<S>(4);
            direction = axis_direction<S>(random);
            radius = static_cast<S>(1 + random.below(3));
            break;
        default:
            radius = std::abs(random.magnitude<S>(-20, 20));
    }
    row.vec(origin), row.vec(direction), row.vec(center), row.real(radius), row.flag(random.one_in(4));
};

TEST(KernelAgreement, SphereDistance) {
    expect_lanes_agree(kRayAndSphere, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Vec3<Real> origin = in.vec();
        const Vec3<Real> direction = in.vec();
        const Vec3<Real> center = in.vec();
        const Real radius = in.real();
        out(sphere_distance<Real>(origin, direction, center, radius, in.flag()));
    });
}

TEST(KernelAgreement, PlaneAndQuadDistance) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const bool is_lattice = random.one_in(2);  // many hits on an edge, in a corner, or along the plane
        const Vec3<S> origin = is_lattice ? random.lattice_point<S>(3) : random.point<S>(4);
        Vec3<S> u = is_lattice ? axis_direction<S>(random) : random.direction<S>();
        const Vec3<S> v = perpendicular<S>(u);
        const Vec3<S> normal = vec3<S>(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
        const S stretch = is_lattice ? S(2) : static_cast<S>(random.uniform(0.2, 8));
        const Vec3<S> direction = is_lattice ? unit<S>(random.lattice_point<S>(2)) : random.direction<S>();
        row.vec(origin), row.vec(direction), row.vec(random.lattice_point<S>(2)), row.vec(normal);
        row.vec(u / stretch), row.vec(v / stretch), row.flag(random.one_in(8));
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Vec3<Real> origin = in.vec();
        const Vec3<Real> direction = in.vec();
        const Vec3<Real> corner = in.vec();
        const Vec3<Real> normal = in.vec();
        const Vec3<Real> dual_u = in.vec();
        const Vec3<Real> dual_v = in.vec();
        const Mask<Real> is_leaving = in.flag();
        out(plane_distance<Real>(origin, direction, corner, normal, is_leaving));
        out(quad_distance<Real>(origin, direction, corner, normal, corner, dual_u, dual_v, is_leaving));
        out(plane_coordinates<Real>(origin, corner, dual_u, dual_v));
    });
}

TEST(KernelAgreement, BoxTest) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const bool is_lattice = random.one_in(2);  // in faces, edges and corners; along axes; flat boxes
        Vec3<S> a = is_lattice ? random.lattice_point<S>(2) : random.point<S>(4);
        Vec3<S> b = is_lattice ? random.lattice_point<S>(2) : random.point<S>(4);
        row.vec(is_lattice ? random.lattice_point<S>(3) : random.point<S>(6));
        row.vec(is_lattice ? random.lattice_point<S>(1) : random.direction<S>());
        row.vec(a.cwiseMin(b)), row.vec(a.cwiseMax(b));
        row.real(static_cast<S>(random.uniform(0, 10)));
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Vec3<Real> origin = in.vec();
        const Vec3<Real> direction = in.vec();
        const Vec3<Real> low = in.vec();
        const Vec3<Real> high = in.vec();
        const Real t = in.real();
        const RayInverse<Real> inverse = ray_inverse<Real>(direction);
        out(inverse.near_scale), out(inverse.far_scale);
        for (const Mask<Real>& is_negative : inverse.is_negative) out.mask(is_negative);
        const Interval<Real> inside = box_interval<Real>(low, high, origin, inverse, t);
        out(inside.enter), out(inside.exit);
        out.mask(is_inside_box<Real>(low, high, origin, inverse, t));
    });
}

TEST(KernelAgreement, DiffuseMirrorAndFuzzyDirections) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const Vec3<S> normal = random.one_in(4) ? axis_direction<S>(random) : random.direction<S>();
        Vec3<S> on_sphere = random.direction<S>();
        if (random.one_in(4)) on_sphere = along<S>(-normal, random.magnitude<S>(-30, -10), on_sphere);  // cancels
        if (random.one_in(8)) on_sphere = -normal;
        row.vec(normal), row.vec(on_sphere), row.vec(random.one_in(8) ? Vec3<S>(-normal) : random.direction<S>());
        row.real(random.one_in(4) ? S(random.below(2)) : random.unit_interval<S>());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Vec3<Real> normal = in.vec();
        const Vec3<Real> on_sphere = in.vec();
        const Vec3<Real> direction = in.vec();
        out(diffuse_direction<Real>(normal, on_sphere));
        out(mirror_direction<Real>(direction, normal));
        out(fuzzy_direction<Real>(direction, in.real(), on_sphere));
    });
}

TEST(KernelAgreement, FresnelSplit) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const S ior = random.one_in(2) ? S(1.5) : static_cast<S>(random.uniform(0.1, 10));
        const S eta = random.one_in(8) ? S(1) : random.one_in(2) ? ior : 1 / ior;
        const Vec3<S> normal = random.direction<S>();
        Vec3<S> direction = random.direction<S>();
        if (dot<S>(direction, normal) > 0) direction = -direction;
        if (random.one_in(4)) direction = -normal;
        if (random.one_in(4) && eta > 1) {  // at the critical angle
            const S sine = (1 + random.magnitude<S>(-26, -12)) / eta;
            direction = unit<S>(along<S>(sine * perpendicular<S>(normal), -std::sqrt(1 - sine * sine), normal));
        }
        row.vec(direction), row.vec(normal), row.real(eta);
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Vec3<Real> direction = in.vec();
        const Vec3<Real> normal = in.vec();
        const FresnelSplit<Real> split = fresnel_split<Real>(direction, normal, in.real());
        out(split.reflectance), out(split.refracted);
    });
}

TEST(KernelAgreement, WarpsAndElementaryFunctions) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        for (int i = 0; i < 2; ++i) row.real(random.one_in(8) ? S(random.below(9)) / 8 : random.unit_interval<S>());
        for (int i = 0; i < 2; ++i) row.real(random.one_in(4) ? S(random.below(3) - 1) : random.magnitude<S>(-30, 30));
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Real u = in.real();
        const Real v = in.real();
        const Real y = in.real();
        const SinCos<Real> angle = sincos_of_turn<Real>(u);
        out(angle.sin), out(angle.cos), out(turn_of_angle<Real>(y, in.real()));
        out(unit_sphere<Real>(u, v)), out(unit_disc<Real>(u, v));
    });
}

TEST(KernelAgreement, RandomBlocks) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const auto shift = static_cast<unsigned>(random.below(32));
        row.word(random.word()), row.word(random.word() >> shift), row.word(random.word() >> random.below(32));
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Uint32<Real> pixel = in.word();
        const PathKey<Real> path{pixel, in.word()};
        const Uint32<Real> step = in.word();
        out(random_block<Real>(path, step, RandomPurpose::Film, random_seed(0)));
        out(random_block<Real>(path, step, RandomPurpose::Scatter, {0xffffffffU, 0x80000001U}));
        out(random_block<Real>(path, step, RandomPurpose::Film, random_seed(0, Sampler::Sobol)));
        out(random_block<Real>(path, step, RandomPurpose::Scatter, {0xffffffffU, 0x80000001U, Sampler::Sobol}));
    });
}

TEST(KernelAgreement, CheckersSphereCoordinatesAndSky) {
    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const double edge = random.one_in(2) ? 0.32 : random.uniform(0.01, 3);
        const S high = static_cast<S>(1 / edge);
        row.real(high), row.real(static_cast<S>(1 / edge - static_cast<double>(high)));
        for (int i = 0; i < 3; ++i) {  // on a boundary, or next to one, or anywhere
            const S boundary = static_cast<S>(edge * (random.below(2001) - 1000));
            row.real(random.one_in(3)   ? boundary
                     : random.one_in(2) ? std::nextafter(boundary, S(random.below(2000) - 1000))
                                        : random.magnitude<S>(-10, 30));
        }
        row.vec(random.one_in(8) ? axis_direction<S>(random) : random.direction<S>());
    };
    expect_lanes_agree(fill, []<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const Real high = in.real();
        const TwoParts<Real> scale{high, in.real()};
        const Vec3<Real> p = in.vec();
        const Vec3<Real> n = in.vec();
        Vec3<Real> outward;
        for (int i = 0; i < 3; ++i) outward[i] = outward_part<Real>(p[i], n[i], scale, n[i]);
        for (int i = 0; i < 3; ++i) out(cell_parity<Real>(p[i], scale, outward[i]));
        out.mask(is_odd_cell<Real>(p, outward, scale));
        out(sphere_coordinates<Real>(n));
        using S = ScalarOf<Real>;
        out(sky_radiance<Real>({vec3<S>(S(0.75), S(0.85), 1), vec3<S>(S(-0.25), S(-0.15), 0)}, n));
    });
}

TEST(KernelAgreement, CameraRays) {
    CameraDescription description;
    description.look_from = {13, 2, 3};
    description.look_at = {0, 0, 0};
    description.vertical_fov_degrees = 20;
    description.defocus_angle_degrees = 0.6;
    description.focus_distance = 10;
    description.shutter_open = 0.25;
    description.shutter_close = 1;
    constexpr std::uint32_t kEdge = 65536;
    const Camera<float> in_float = make_camera<float>(description, kEdge, kEdge);
    const Camera<double> in_double = make_camera<double>(description, kEdge, kEdge);

    const auto fill = []<class S>(RandomInputs& random, Row<S>& row) {
        const std::uint32_t x = random.word() % kEdge;
        const std::uint32_t y = random.word() % kEdge;
        row.real(S(x)), row.real(S(y)), row.word(y * kEdge + x), row.word(random.word() >> 1U);
    };
    expect_lanes_agree(fill, [&]<class Real>(Arguments<Real>& in, Results<Real>& out) {
        const auto& camera = [&]() -> const auto& {
            if constexpr (sizeof(ScalarOf<Real>) == 4) {
                return in_float;
            } else {
                return in_double;
            }
        }
        ();
        const Real x = in.real();
        const Real y = in.real();
        const Uint32<Real> pixel = in.word();
        const Uint32<Real> sample = in.word();
        const auto add = [&](const Ray<Real>& ray) { out(ray.origin), out(ray.direction), out(ray.time); };
        add(camera_ray<kEverything, Real>(camera, x, y, pixel, sample, random_seed(1)));
        add(camera_ray<Features{}, Real>(camera, x, y, pixel, sample, random_seed(1)));
    });
}

}  // namespace
}  // namespace raypool::test
