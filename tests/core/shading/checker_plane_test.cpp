/// A 3-D checker on surfaces that lie in boundaries of its cells: one cell, that on the outward side, never a mixture.
#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/traverse.h"
#include "core/shading/shade.h"
#include "tests/physics/test_scene.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

struct Floor {
    double height, scale, offset;  ///< (height + offset) / scale is whole
    double translation;            ///< of what is looked at, along x and z
    double distance;               ///< of the camera
    double side;                   ///< +1 or -1: of the normal
    double tilt;                   ///< of the normal: less than rounding can tell
    bool is_quad;
};

template <class Scalar>
void expect_one_layer_of_cells(const Floor& floor, std::uint64_t seed) {
    RandomInputs random(seed);
    TestScene scene(8, 8, Vector3d::Zero());
    const std::int32_t lamp = scene.emitter(0);
    Texture& texture = scene.textures[0];
    texture.kind = Texture::Kind::Checker3d;
    texture.even = Vector3d::Zero();
    texture.odd = Vector3d::Ones();
    texture.scale = floor.scale;
    texture.offset = {0, floor.offset, 0};
    const Vector3d at(floor.translation, floor.height, floor.translation);
    if (floor.is_quad) {
        const Vector3d u(40, 40 * floor.tilt, 0);
        const Vector3d v(0, 0, -40 * floor.side);
        scene.quad(at - 0.5 * u - 0.5 * v, u, v, lamp);
    } else {
        scene.plane(at, {-floor.tilt, floor.side, 0}, lamp);
    }
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    const double boundary = std::round((floor.height + floor.offset) / floor.scale);
    const double layer = floor.side > 0 ? boundary : boundary - 1;
    int seen = 0;
    int wrong = 0;
    for (int i = 0; i < 200; ++i) {
        const Vector3d target = at + Vector3d(random.uniform(-9, 9), 0, random.uniform(-9, 9));
        Vector3d away = random.direction<double>();
        if (std::abs(away.y()) < 0.05) continue;
        Ray<Scalar> ray{(target + floor.distance * away).cast<Scalar>(), (-away).cast<Scalar>(), 0};
        NoTestCount work;
        const Hit<Scalar> hit = closest_hit<kEverything>(compiled, ray, kNoPrimitive, work);
        if (hit.primitive_id == kNoPrimitive) continue;
        const Scattered<Scalar> out =
            scatter<kEverything, Scalar>(compiled, ray, hit.t, 0, vec3<Scalar>(1, 1, 1), {0, 0}, 0, random_seed(0));
        const double x = static_cast<double>(out.start.origin[0]) / floor.scale;
        const double z = static_cast<double>(out.start.origin[2]) / floor.scale;
        constexpr double kFromEdges = 1e-3;
        if (std::abs(x - std::round(x)) < kFromEdges || std::abs(z - std::round(z)) < kFromEdges) continue;
        const double sum = std::floor(x) + layer + std::floor(z);
        const bool is_odd = sum - 2 * std::floor(sum / 2) != 0;
        ++seen;
        wrong += (out.throughput[0] != 0) != is_odd ? 1 : 0;
    }
    EXPECT_GT(seen, 50) << floor.scale << ' ' << floor.translation << ' ' << floor.distance;
    EXPECT_EQ(wrong, 0) << "of " << seen << ", height " << floor.height << ", scale " << floor.scale << ", offset "
                        << floor.offset << ", at " << floor.translation << ", from " << floor.distance << ", side "
                        << floor.side << ", tilt " << floor.tilt << (floor.is_quad ? ", a quad" : ", a plane");
}

TEST(CheckerInABoundary, TakesTheCellsOnTheOutwardSide) {
    struct Place {
        double height, scale, offset;
    };
    const Place places[] = {{0, 1, 0},      {0, 0.1, 0},     {0, 0.3, 0},      {0.3, 0.3, 0},
                            {0.3, 0.1, 0},  {-0.7, 0.1, 0},  {0.2, 0.3, 0.1},  {5, 1, -3},
                            {0.1, 1, -0.1}, {7.7, 0.7, 1.4}, {100.3, 1, -99.3}};
    std::uint64_t seed = 0;
    for (const Place& place : places)
        for (const double translation : {0.0, 1e3, 1e5})
            for (const double distance : {1.0, 30.0, 1e3})
                for (const double side : {1.0, -1.0})
                    for (const double tilt : {0.0, 1.0, -1.0})
                        for (const bool is_quad : {false, true}) {
                            Floor floor{place.height, place.scale, place.offset, translation,
                                        distance,     side,        tilt,         is_quad};
                            floor.tilt = 6e-17 * tilt;
                            expect_one_layer_of_cells<float>(floor, ++seed);
                            floor.tilt = 1e-18 * tilt;
                            expect_one_layer_of_cells<double>(floor, ++seed);
                        }
}

}  // namespace
}  // namespace raypool::test
