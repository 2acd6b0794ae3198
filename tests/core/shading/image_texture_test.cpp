/// Lookups in images, by themselves and on shapes: where texels lie, what mixes, and where an image ends or repeats.
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/geometry/traverse.h"
#include "core/shading/compiled_scene.h"
#include "core/shading/shade.h"
#include "core/shading/textures.h"
#include "tests/core/shading/colour_of.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

/// Two texels wide, two high: red, green over blue, white.
class FourTexels {
  public:
    [[nodiscard]] Vec3<float> at(float u, float v, ImageRepeat repeat = {}) const {
        return image_colour<float>({texels_.data(), 2, 2}, u, v, repeat);
    }

  private:
    std::array<float, 16> texels_{1, 0, 0, 9, 0, 1, 0, 9, 0, 0, 1, 9, 1, 1, 1, 9};
};

TEST(ImageColour, IsTheTexelAtItsCentreWithVUpward) {
    const FourTexels image;
    EXPECT_EQ(image.at(0.25F, 0.75F), vec3<float>(1, 0, 0));
    EXPECT_EQ(image.at(0.75F, 0.75F), vec3<float>(0, 1, 0));
    EXPECT_EQ(image.at(0.25F, 0.25F), vec3<float>(0, 0, 1));
    EXPECT_EQ(image.at(0.75F, 0.25F), vec3<float>(1, 1, 1));
}

TEST(ImageColour, MixesNeighboursAndClampsAtTheEdges) {
    const FourTexels image;
    EXPECT_EQ(image.at(0.5F, 0.75F), vec3<float>(0.5F, 0.5F, 0));
    EXPECT_EQ(image.at(0.5F, 0.5F), vec3<float>(0.5F, 0.5F, 0.5F));
    for (const float beyond : {0.0F, -1.0F, -1e30F}) {
        EXPECT_EQ(image.at(beyond, 1 - beyond), vec3<float>(1, 0, 0));
        EXPECT_EQ(image.at(1 - beyond, beyond), vec3<float>(1, 1, 1));
    }
}

TEST(ImageColour, BeginsAnewWhereItRepeats) {
    const FourTexels image;
    const ImageRepeat both{true, true};
    for (const float u : {0.25F, 0.5F, 0.0625F, 0.9375F}) {
        for (const float v : {0.25F, 0.5F, 0.125F, 0.875F}) {
            for (const float shift : {-3.0F, -1.0F, 1.0F, 64.0F}) {
                EXPECT_EQ(image.at(u + shift, v, both), image.at(u, v, both)) << u << ' ' << v << ' ' << shift;
                EXPECT_EQ(image.at(u, v + shift, both), image.at(u, v, both)) << u << ' ' << v << ' ' << shift;
            }
        }
    }
    EXPECT_EQ(image.at(1.25F, 2, {true, false}), image.at(0.25F, 1));
    EXPECT_EQ(image.at(2, 1.25F, {false, true}), image.at(1, 0.25F));
}

TEST(ImageColour, MixesOppositeEdgesWhereItRepeats) {
    const FourTexels image;
    for (const float edge : {0.0F, 1.0F, -5.0F}) {
        EXPECT_EQ(image.at(edge, 0.75F, {true, false}), vec3<float>(0.5F, 0.5F, 0));
        EXPECT_EQ(image.at(0.25F, edge, {false, true}), vec3<float>(0.5F, 0, 0.5F));
    }
    // An eighth of the image beyond the edge and before it: a quarter of the way to the other texel.
    EXPECT_EQ(image.at(0.125F, 0.75F, {true, false}), vec3<float>(0.75F, 0.25F, 0));
    EXPECT_EQ(image.at(0.875F, 0.75F, {true, false}), vec3<float>(0.25F, 0.75F, 0));
}

/// The colour of the one shape of `scene` where a ray from `origin` through `target` meets it.
template <class Scalar>
Vec3<double> colour_seen(Scene scene, Texture::Wrap wrap, const Vec3<double>& origin, const Vec3<double>& target) {
    const auto texels = std::make_shared<Image>(2, 2);
    texels->rgb = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    Texture& texture = scene.textures.emplace_back();
    texture.kind = Texture::Kind::Image;
    texture.image = texels;
    texture.wrap = wrap;
    scene.materials.emplace_back();
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    const Ray<Scalar> ray{origin.cast<Scalar>(), unit<Scalar>((target - origin).cast<Scalar>()), 0};
    const auto* row = compiled.surfaces[0].value;
    const SurfacePoint<Scalar> point =
        surface_point<kEverything, Scalar>(ray, static_cast<Scalar>((target - origin).norm()), row);
    return colour_of(compiled, point, 0, row);
}

using Wrap = Texture::Wrap;

TEST(ImageOnASphere, HasNoSeamAndEndsAtThePoles) {
    Scene scene;
    scene.spheres.push_back({{0, 0, 0}, {0, 0, 0}, 1, 0});
    const auto seen = [&](Wrap wrap, const Vec3<double>& at) { return colour_seen<float>(scene, wrap, 3 * at, at); };
    const auto at_turn = [](double u, double y) {
        const double turn = 2 * std::numbers::pi * (u - 0.5), r = std::sqrt(1 - y * y);
        return Vec3<double>(r * std::cos(turn), y, -r * std::sin(turn));
    };
    for (const Wrap wrap : {Wrap::ByShape, Wrap::Repeat}) {
        for (const double y : {0.9, 0.0, -0.5}) {
            EXPECT_LT((seen(wrap, at_turn(1e-5, y)) - seen(wrap, at_turn(1 - 1e-5, y))).norm(), 1e-3) << y;
        }
        const double upper = std::sin(std::numbers::pi / 4);  // v = 3 / 4, the middle of the upper texels
        EXPECT_LT((seen(wrap, at_turn(0.125, upper)) - Vec3<double>(0.75, 0.25, 0)).norm(), 1e-5);
        EXPECT_LT((seen(wrap, at_turn(0.25, 0.999999)) - Vec3<double>(1, 0, 0)).norm(), 1e-5);   // nothing of the blue
        EXPECT_LT((seen(wrap, at_turn(0.25, -0.999999)) - Vec3<double>(0, 0, 1)).norm(), 1e-5);  // nothing of the red
    }
    EXPECT_LT((seen(Wrap::Clamp, at_turn(1e-5, 0.9)) - Vec3<double>(1, 0, 0)).norm(), 1e-5);
    EXPECT_LT((seen(Wrap::Clamp, at_turn(1 - 1e-5, 0.9)) - Vec3<double>(0, 1, 0)).norm(), 1e-5);
}

TEST(ImageOnAPlane, RepeatsEveryUnitUnlessClamped) {
    Scene scene;
    scene.planes.push_back({{2, 0, 5}, {0, 1, 0}, 0});
    const auto seen = [&](Wrap wrap, double u, double v) {  // u runs along x, v against z
        const Vec3<double> at(2 + u, 0, 5 - v);
        return colour_seen<double>(scene, wrap, at + Vec3<double>(0, 3, 0), at);
    };
    const Vec3<double> red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1);
    for (const Wrap wrap : {Wrap::ByShape, Wrap::Repeat}) {
        for (const double shift : {0.0, 1.0, -3.0}) {
            EXPECT_LT((seen(wrap, 0.25 + shift, 0.75 - shift) - red).norm(), 1e-9);
            EXPECT_LT((seen(wrap, 0.75 + shift, 0.75) - green).norm(), 1e-9);
            EXPECT_LT((seen(wrap, 0.25, 0.25 + shift) - blue).norm(), 1e-9);
        }
    }
    EXPECT_LT((seen(Wrap::Clamp, -3, 7) - red).norm(), 1e-9);
    EXPECT_LT((seen(Wrap::Clamp, 1.25, 1) - green).norm(), 1e-9);
}

TEST(ImageOnAQuad, DoesNotBleedOverItsBorderUnlessItRepeats) {
    Scene scene;
    scene.quads.push_back({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0});
    const auto seen = [&](Wrap wrap, double u, double v) {
        return colour_seen<double>(scene, wrap, {u, v, 3}, {u, v, 0});
    };
    for (const Wrap wrap : {Wrap::ByShape, Wrap::Clamp}) {
        EXPECT_LT((seen(wrap, 0, 1) - Vec3<double>(1, 0, 0)).norm(), 1e-9);
        EXPECT_LT((seen(wrap, 1, 1) - Vec3<double>(0, 1, 0)).norm(), 1e-9);
        EXPECT_LT((seen(wrap, 0, 0) - Vec3<double>(0, 0, 1)).norm(), 1e-9);
    }
    EXPECT_LT((seen(Wrap::Repeat, 0, 1) - Vec3<double>(0.5, 0.5, 0.5)).norm(), 1e-9);
}

TEST(ImageColour, ReadsNoTexelOutsideForAnyCoordinates) {
    const FourTexels image;
    RandomInputs random(4);
    for (int i = 0; i < kInputs / 10; ++i) {
        const float u = random.any<float>();
        const ImageRepeat repeat{random.one_in(2), random.one_in(2)};
        const float v = random.one_in(4) ? random.special<float>() : random.any<float>();
        const Vec3<float> colour = image.at(u, v, repeat);
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(colour[k] >= 0 && colour[k] <= 1);
    }
}

}  // namespace
}  // namespace raypool::test
