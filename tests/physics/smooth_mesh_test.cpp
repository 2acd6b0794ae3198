// Meshes with normals: what their triangles lose of light, where they hide it from themselves, and that all ways to
// find lights have one mean.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/meshes.h"
#include "tests/physics/light_renders.h"

namespace raypool {
namespace {

void add_mesh(TestScene& scene, Mesh mesh, std::int32_t material, const Vector3d& center = Vector3d::Zero()) {
    MeshShape shape{std::make_shared<const Mesh>(std::move(mesh))};
    shape.transform.col(3) = center;
    shape.material_id = material;
    scene.meshes.push_back(std::move(shape));
}

/// The lower half of a ball, open above.
Mesh bowl(int levels) {
    Mesh mesh = test::smooth_icosphere(levels);
    std::erase_if(mesh.triangles, [&](const Mesh::Triangle& triangle) {
        return mesh.positions[triangle[0]][1] + mesh.positions[triangle[1]][1] + mesh.positions[triangle[2]][1] > 0;
    });
    return mesh;
}

/// Part of the light that a white mesh keeps back under a white sky, of the light of the pixels that show it.
template <class Scalar>
double loss(const Mesh& mesh, std::int32_t material_of(TestScene&)) {
    TestScene scene(64, 64, Vector3d::Ones());
    add_mesh(scene, mesh, material_of(scene));
    scene.look({0, 2, 2.5}, {0, 0, 0}, 45);
    constexpr std::int64_t kSpp = 64;
    const Rendered rendered = render<Scalar>(scene, kSpp, 1000);
    const auto hits = static_cast<double>(hit_count<Scalar>(scene, kSpp));
    EXPECT_GT(hits, 0.2 * 64 * 64 * kSpp);
    EXPECT_EQ(rendered.report.statistics.non_finite, 0);
    return (1 - rendered.mean(0)) * 64 * 64 * kSpp / hits;
}

template <class Scalar>
class SmoothFurnace : public testing::Test {};
using SmoothPrecisions = testing::Types<float, double>;
TYPED_TEST_SUITE(SmoothFurnace, SmoothPrecisions);

constexpr auto kWhite = [](TestScene& scene) { return scene.diffuse(1); };
constexpr auto kMirror = [](TestScene& scene) { return scene.mirror(1); };
constexpr auto kGlass = [](TestScene& scene) { return scene.glass(1.5); };

/// From outside of a convex mesh rays start above it, and what they meet of it sends them on.
TYPED_TEST(SmoothFurnace, LosesNextToNothingOutsideOfABall) {
    for (const int levels : {0, 1, 3}) {
        const Mesh ball = test::smooth_icosphere(levels);
        EXPECT_LT(loss<TypeParam>(ball, kWhite), 1e-4) << levels;
        EXPECT_GE(loss<TypeParam>(ball, kWhite), 0) << levels;
    }
}

/// In a hollow, directions below a triangle are lost: a part of (1 - cos a) / 2 where the normals differ by a.
TYPED_TEST(SmoothFurnace, LosesALittleInABowl) {
    EXPECT_LT(loss<TypeParam>(bowl(1), kWhite), 0.02);
    EXPECT_GT(loss<TypeParam>(bowl(1), kWhite), 0.002);
    EXPECT_LT(loss<TypeParam>(bowl(3), kWhite), 0.0015);
}

/// Mirrors and glass lose what they send below a triangle, most of it at silhouettes.
TYPED_TEST(SmoothFurnace, LosesALittleOfMirrorsAndGlass) {
    EXPECT_LT(loss<TypeParam>(test::smooth_icosphere(1), kMirror), 1e-4);
    EXPECT_LT(loss<TypeParam>(test::smooth_icosphere(1), kGlass), 0.01);
    EXPECT_LT(loss<TypeParam>(test::smooth_icosphere(3), kGlass), 5e-4);
}

/// A ball that a small far lamp grazes, by light sampling: pixels that show lit parts of the ball and get no light.
std::int64_t black_pixels(const Mesh& mesh) {
    TestScene scene(96, 96, Vector3d::Zero());
    add_mesh(scene, mesh, scene.diffuse(0.8));
    const Vector3d lamp(100, 0, 20);
    scene.sphere(lamp, 1, scene.emitter(5000));
    scene.look({0, 0, 6}, {0, 0, 0}, 18);
    const std::vector<double> values = pixel_values(render_with<float>(scene, LightSampling::Light, 16, 0, 2));
    std::int64_t black = 0;
    for (int y = 0; y < 96; ++y) {
        for (int x = 0; x < 96; ++x) {
            // Where the pixel sees the sphere of radius 0.95, and the light is a tenth above its horizon or more.
            const double scale = 2 * std::tan(9 * 3.141592653589793 / 180) / 96;
            const Vector3d way = Vector3d((x + 0.5 - 48) * scale, (48 - y - 0.5) * scale, -1).normalized();
            const Vector3d from(0, 0, 6);
            const double b = from.dot(way);
            const double discriminant = b * b - from.squaredNorm() + 0.95 * 0.95;
            if (discriminant < 0) continue;
            const Vector3d normal = (from + (-b - std::sqrt(discriminant)) * way).normalized();
            if (normal.dot(lamp.normalized()) > 0.1 && values[static_cast<std::size_t>(y * 96 + x)] == 0) ++black;
        }
    }
    return black;
}

TEST(SmoothTerminator, HasNoBlackTriangles) {
    Mesh flat = test::smooth_icosphere(1);
    const std::int64_t of_smooth = black_pixels(flat);
    flat.normals.clear();
    EXPECT_GT(black_pixels(flat), 200);
    EXPECT_LE(of_smooth, 2);
}

struct SmoothCase {
    const char* name;
    void (*add)(TestScene&);
};
constexpr SmoothCase kSmoothCases[] = {
    {"ball",
     [](TestScene& s) {
         add_mesh(s, test::smooth_icosphere(1), s.diffuse(0.8), {0, 1, 0});
     }},
    {"bowl",
     [](TestScene& s) {
         add_mesh(s, bowl(1), s.diffuse(0.8), {0, 1.5, 0});
     }},
    {"fuzzy_mirrors",
     [](TestScene& s) {
         for (const double fuzz : {1.0, 0.3}) {
             const std::int32_t mirror = s.mirror(0.9);
             s.materials.back().fuzz = fuzz;
             add_mesh(s, test::smooth_icosphere(0), mirror, {fuzz - 0.8, 1, 2 * fuzz - 1.5});
         }
     }},
};

class SmoothLightSampling : public testing::TestWithParam<SmoothCase> {};

TEST_P(SmoothLightSampling, HasTheMeansOfChance) {
    TestScene scene(32, 32, {0.02, 0.03, 0.05});
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(0.6));
    scene.quad({2, 1, -1}, {0, 1.5, 0}, {0, 0, 2}, scene.emitter(3));
    scene.look({0.5, 2.5, 4}, {0, 0.8, 0}, 40);
    GetParam().add(scene);
    const Rendered by_chance = render_with<float>(scene, LightSampling::None, 600);
    for (const LightSampling sampling : {LightSampling::Mis, LightSampling::Light}) {
        const Rendered rendered = render_with<float>(scene, sampling, 150, 1);
        EXPECT_TRUE(same_means(by_chance, rendered));
        EXPECT_EQ(rendered.report.statistics.non_finite, 0);
    }
}
INSTANTIATE_TEST_SUITE_P(Physics, SmoothLightSampling, testing::ValuesIn(kSmoothCases),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace raypool
