// Light sampling against chance: the same means, whatever shines on whatever; and closed forms by light sampling alone.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "tests/meshes.h"
#include "tests/physics/light_renders.h"

namespace raypool {
namespace {

struct Estimate {
    double mean, error;
};
/// Pixels are independent, but of different expectation: their spread is an upper bound of the error.
Estimate estimate(const Rendered& rendered) {
    const std::vector<double> values = pixel_values(rendered);
    double sum = 0, squares = 0;
    for (const double value : values) sum += value, squares += value * value;
    const auto count = static_cast<double>(values.size());
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / count)};
}

/// A floor and a wall that see a lamp, with whatever a case adds.
TestScene corner() {
    TestScene scene(48, 48, {0.02, 0.03, 0.05});
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(0.7));
    scene.quad({-3, 0, -3}, {6, 0, 0}, {0, 4, 0}, scene.diffuse(0.5));
    scene.look({1, 2, 6}, {0, 1, 0}, 50);
    scene.camera.shutter_close = 1;
    return scene;
}

struct Case {
    const char* name;
    void (*add)(TestScene&);
};
constexpr Case kCases[] = {
    {"quad",
     [](TestScene& s) {
         s.quad({-1, 2.5, -1}, {1.5, 0, 0}, {0, 0, 1.5}, s.emitter(3));
     }},
    {"quad_of_one_side",
     [](TestScene& s) {
         s.quad({-1, 2.5, -1}, {1.5, 0, 0}, {0, 0.3, 1.5}, s.emitter(3));
         s.materials.back().front_only = true;
     }},
    {"sphere",
     [](TestScene& s) {
         s.sphere({0, 1.4, 0}, 0.6, s.emitter(3));
     }},
    {"moving_sphere",
     [](TestScene& s) {
         s.sphere({-1, 1.4, 0}, 0.5, s.emitter(3));
         s.spheres.back().center1 = {1, 2, 0.5};
     }},
    {"sphere_around_all",
     [](TestScene& s) {
         s.sphere({0, 1, 1}, 9, s.emitter(0.6));
     }},
    {"lamp_that_touches_the_wall",
     [](TestScene& s) {
         s.quad({-1, 1, -3}, {2, 0, 0}, {0, 1.5, 1}, s.emitter(2));
     }},
    {"lamp_in_the_plane_of_the_floor",
     [](TestScene& s) {
         s.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, s.emitter(2));
     }},
    {"plane",
     [](TestScene& s) {
         s.plane({0, 5, 0}, {0, 1, 0}, s.emitter(0.5));
     }},
    {"checker_lamp",
     [](TestScene& s) {
         const std::int32_t lamp = s.emitter(4);
         s.textures.back().kind = Texture::Kind::CheckerUv;
         s.textures.back().scale = 0.25;
         s.materials.back().strength = 1.5;
         s.quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, lamp);
     }},
    {"shining_mesh",
     [](TestScene& s) {
         s.mesh(test::icosphere(1), s.emitter(3), 0.6, {0, 1.4, 0});
     }},
    {"mirrored_mesh_of_one_side",
     [](TestScene& s) {
         s.mesh(test::icosphere(0), s.emitter(3), -0.5, {-1, 1.4, 0});
         s.materials.back().front_only = true;
     }},
    {"mesh_with_a_checker",
     [](TestScene& s) {
         const std::int32_t lamp = s.emitter(4);
         s.textures.back().kind = Texture::Kind::CheckerUv;
         s.textures.back().scale = 0.25;
         Mesh mesh;
         mesh.positions = {{-1, 2, -1}, {1, 2.5, -1}, {1, 2, 1}, {-1, 2, 1}};
         mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
         mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
         s.mesh(std::move(mesh), lamp);
     }},
    {"mirror_and_glass",
     [](TestScene& s) {
         s.quad({-1, 2.5, -1}, {2, 0, 0}, {0, 0, 2}, s.emitter(2));
         s.sphere({-1, 0.7, 0.5}, 0.7, s.mirror(0.9));
         s.sphere({1, 0.6, 0.5}, 0.6, s.glass(1.5));
     }},
    {"fuzzy_mirrors",
     [](TestScene& s) {
         s.quad({-1, 2.5, -1}, {2, 0, 0}, {0, 0, 2}, s.emitter(2));
         for (int i = 0; i < 3; ++i) {
             const std::int32_t mirror = s.mirror(0.9);
             s.materials.back().fuzz = std::array{1.0, 0.5, 0.1}[static_cast<std::size_t>(i)];
             s.sphere({-1.2 + i, 0.5, 0.5}, 0.5, mirror);
         }
     }},
    {"many_of_different_power",
     [](TestScene& s) {
         for (int i = 0; i < 12; ++i)
             s.sphere({-2 + 0.35 * i, 0.3 + 0.1 * (i % 5), -1 + 0.4 * (i % 3)}, 0.1 + 0.02 * i,
                      s.emitter(1 << (i % 4)));
         s.quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 0.3}, s.emitter(1));
     }},
};

class LightSamplingCase : public testing::TestWithParam<Case> {
  protected:
    template <class Scalar>
    static void expect_equal_means() {
        TestScene scene = corner();
        GetParam().add(scene);
        const Rendered by_chance = render_with<Scalar>(scene, LightSampling::None, 400);
        for (const LightSampling sampling : {LightSampling::Mis, LightSampling::Light}) {
            const Rendered rendered = render_with<Scalar>(scene, sampling, 100, 1);
            EXPECT_TRUE(same_means(by_chance, rendered));
            EXPECT_TRUE(sampling == LightSampling::Light || rendered.report.statistics.clamped == 0);
            EXPECT_EQ(rendered.report.statistics.non_finite, 0);
        }
    }
};
TEST_P(LightSamplingCase, HasTheMeansOfChanceInFloat) {
    expect_equal_means<float>();
}
TEST_P(LightSamplingCase, HasTheMeansOfChanceInDouble) {
    expect_equal_means<double>();
}
INSTANTIATE_TEST_SUITE_P(Physics, LightSamplingCase, testing::ValuesIn(kCases),
                         [](const auto& info) { return std::string(info.param.name); });

/// A spot below a sphere: irradiance (r / d)^2 cos, to the noise of light sampling, which the same samples by chance
/// exceed tenfold.
TEST(LightSampling, MeetsTheClosedFormOfASphereWithLittleNoise) {
    TestScene scene(64, 64, Vector3d::Zero());
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(0.8));
    scene.look({0.5, 1, 8}, {0, 0, 0}, 0.01);
    scene.sphere({2, 2, 1}, 0.2, scene.emitter(3));
    const double expected = 0.8 * 3 * (0.2 * 0.2 / 9) * 2 / 3;
    const Rendered by_chance = render_with<float>(scene, LightSampling::None, 16);
    for (const LightSampling sampling : {LightSampling::Light, LightSampling::Mis}) {
        const Rendered rendered = render_with<float>(scene, sampling, 16);
        EXPECT_TRUE(mean_agrees(pixel_values(rendered), expected));
        EXPECT_LT(estimate(rendered).error, estimate(by_chance).error / 10);
        EXPECT_EQ(rendered.report.total(&ThreadReport::shadow_rays), rendered.report.paths());
    }
}

/// The last segment that the depth allows may not be one toward a light.
TEST(LightSampling, KeepsToTheDepth) {
    TestScene scene = corner();
    scene.quad({-1, 2.5, -1}, {1.5, 0, 0}, {0, 0, 1.5}, scene.emitter(3));
    for (const std::int32_t depth : {0, 1, 2, 3}) {
        const std::vector<double> a = pixel_values(render_with<float>(scene, LightSampling::None, 200, 0, depth));
        const std::vector<double> b = pixel_values(render_with<float>(scene, LightSampling::Mis, 200, 1, depth));
        std::vector<double> differences;
        for (std::size_t i = 0; i < a.size(); ++i) differences.push_back(b[i] - a[i]);
        if (depth == 0) {
            EXPECT_EQ(*std::max_element(b.begin(), b.end()), 0);
        } else {
            EXPECT_TRUE(mean_agrees(differences, 0)) << depth;
        }
    }
}

/// In a white room around a small lamp a third of the paths is longer than light sampling goes on: kMostSampledHits.
TEST(LightSampling, LeavesTheHitsBehindTheLastThatItSamplesToChance) {
    TestScene scene(16, 16, Vector3d::Zero());
    scene.sphere({0, 0, 0}, 1, scene.diffuse(0.999));
    scene.sphere({0, 0, 0}, 0.06, scene.emitter(1));
    scene.look({0.5, 0, 0}, {0.5, 0.3, 0.2}, 60);
    constexpr std::int32_t kDepth = 5000;
    const Rendered by_chance = render_with<float>(scene, LightSampling::None, 64, 0, kDepth);
    EXPECT_GT(by_chance.report.segments(), 150 * by_chance.report.paths());
    EXPECT_TRUE(same_means(by_chance, render_with<float>(scene, LightSampling::Mis, 64, 1, kDepth)));

    // So the step of the sums is that of so many parts, however deep paths may go.
    const CompiledScene<float> compiled = compile<float>(scene);
    const auto sums = [&](std::int32_t depth) {
        ImageSettings settings;
        settings.depth = depth;
        settings.light_sampling = LightSampling::Mis;
        return fixed_point(compiled, settings, 64);
    };
    EXPECT_EQ(sums(kMostSampledHits + 1), sums(path_step::kMostBounces));
    EXPECT_EQ(sums(50).scale(), std::ldexp(FixedPoint::make(64, 1).scale(), -6));
    EXPECT_EQ(sums(50).limit, FixedPoint::make(64, 1).limit);
}

/// A closed box whose walls shine and reflect: what is everywhere is radiance / (1 - albedo), and every sample is
/// bounded.
TEST(LightSampling, KeepsAFurnaceWithAShiningWall) {
    TestScene scene(24, 24, Vector3d::Ones());  // a sky of 1 around a half space that shines with 1
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(1));
    scene.quad({-50, 3, -50}, {100, 0, 0}, {0, 0, 100}, scene.emitter(1));
    scene.sphere({0, 1, 0}, 0.8, scene.diffuse(1));
    scene.look({0, 1.5, 4}, {0, 1, 0}, 40);
    const Rendered rendered = render_with<float>(scene, LightSampling::Mis, 64, 0, 400);
    EXPECT_TRUE(mean_agrees(pixel_values(rendered), 1));
    EXPECT_EQ(rendered.report.statistics.clamped, 0);
}

}  // namespace
}  // namespace raypool
