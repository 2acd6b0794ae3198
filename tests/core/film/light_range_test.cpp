/// Dim light beside bright light: what of it rounding may take.
#include "core/film/light_range.h"

#include <gtest/gtest.h>

namespace raypool::test {
namespace {

/// A sky of one radiance over a hidden lamp.
Scene lit_by(double sky, double lamp) {
    Scene scene;
    scene.background.bottom = scene.background.top = Vector3d(0, sky, 0);
    scene.textures.emplace_back().even = Vector3d(0, 0, lamp);
    scene.materials.emplace_back().kind = Material::Kind::Emissive;
    scene.spheres.emplace_back();
    return scene;
}

TEST(DimmestLight, IsTheLeastThatIsNotBlackOfSkyAndLamps) {
    EXPECT_EQ(dimmest_light(lit_by(0.5, 7)), 0.5);
    EXPECT_EQ(dimmest_light(lit_by(0, 7)), 7);
    EXPECT_EQ(dimmest_light(lit_by(3, 0.25)), 0.25);
    EXPECT_EQ(dimmest_light(lit_by(0, 0)), 0);
    Scene not_a_lamp = lit_by(0.5, 0.1);
    not_a_lamp.materials[0].kind = Material::Kind::Diffuse;
    EXPECT_EQ(dimmest_light(not_a_lamp), 0.5) << "an albedo is no light";
    Scene around = lit_by(0, 7);
    auto image = std::make_shared<Image>(2, 1);
    image->rgb = {0, 8, 0, 0, 0, 2};
    around.background.image = image;
    around.background.scale = 0.5;
    EXPECT_EQ(dimmest_light(around), 1);
}

TEST(Rounding, IsBoundedByHalfAStepOverTheRadiance) {
    for (const std::int64_t spp : {std::int64_t{1}, std::int64_t{1'000'000}, (std::int64_t{1} << 31U) - 1}) {
        const FixedPoint fixed = FixedPoint::make(spp, 1e6);
        SampleConverter converter(fixed);
        for (const double sky : {1e-6, 4.8e-4, 0.01, 1.0}) {
            const double kept =
                static_cast<double>(converter.convert<double>(vec3<double>(sky, sky, sky))[0]) / fixed.scale();
            EXPECT_LE(std::abs(kept / sky - 1), rounding_of(sky, fixed) * (1 + 1e-12)) << sky << " at " << spp;
        }
    }
    EXPECT_GT(rounding_of(1e-6, FixedPoint::make(1'000'000, 1e6)), kFineStep);
    EXPECT_LT(rounding_of(1e-6, FixedPoint::make(1'000'000, 10)), kFineStep);
}

}  // namespace
}  // namespace raypool::test
