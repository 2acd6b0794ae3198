/// The scattering rules: their distributions, exact Fresnel reflectance, and directions that stay of length one where
/// rounding is at its worst.
#include "core/shading/materials.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "tests/errors.h"
#include "tests/random_inputs.h"
#include "tests/significance.h"

namespace raypool::test {
namespace {

template <class Scalar>
double length_error(const Vec3<Scalar>& v) {
    return v.template cast<double>().norm() - 1;
}
constexpr double kUnit = 2.5e-7;  ///< how far from one a length may be in float

TEST(DiffuseDirection, IsDistributedAsTheCosine) {
    RandomInputs random(1);
    constexpr int kNormals = 3;
    for (int n = 0; n < kNormals; ++n) {
        const Vec3<float> normal = random.direction<float>();
        const Vec3<double> up = normal.cast<double>();
        const Vec3<double> right = up.unitOrthogonal();
        const Vec3<double> forward = up.cross(right);
        constexpr int kEdge = 20;
        std::vector<std::int64_t> counts(kEdge * kEdge);
        for (int i = 0; i < kDraws; ++i) {
            const auto [u, v] = random.unit_square<float>();
            const auto d = diffuse_direction<float>(normal, unit_sphere<float>(u, v)).cast<double>().eval();
            const double cosine = d.dot(up);
            ASSERT_GE(cosine, 0);
            const double turn = std::atan2(d.dot(right), d.dot(forward)) / (2 * std::numbers::pi) + 0.5;
            const int row = std::min(static_cast<int>(cosine * cosine * kEdge), kEdge - 1);
            const int column = std::min(static_cast<int>(turn * kEdge), kEdge - 1);
            ++counts[static_cast<std::size_t>(row * kEdge + column)];
        }
        EXPECT_FALSE(is_significant(p_value_of_uniform_counts(counts), kNormals));
    }
}

TEST(DiffuseDirection, IsTheNormalWhereTheSumCancels) {
    RandomInputs random(2);
    Errors errors;
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> normal = random.direction<float>();
        const Vec3<float> opposite = -normal;
        ASSERT_EQ(diffuse_direction<float>(normal, opposite), unit<float>(normal));
        const float shift = random.magnitude<float>(-40, -8);
        const Vec3<float> nearly = along<float>(opposite, shift, random.direction<float>());
        errors.add(length_error<float>(diffuse_direction<float>(normal, nearly)));
    }
    EXPECT_LT(errors.max(), kUnit);
}

TEST(MirrorDirection, KeepsItsLengthOverAMillionBounces) {
    RandomInputs random(3);
    Vec3<float> direction = random.direction<float>();
    Errors errors;
    for (int i = 0; i < kInputs; ++i) {
        direction = mirror_direction<float>(direction, random.direction<float>());
        errors.add(length_error<float>(direction));
    }
    EXPECT_LT(errors.max(), kUnit);
}

TEST(MirrorDirection, FollowsTheLawOfReflection) {
    RandomInputs random(4);
    Errors errors;
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<double> n = random.direction<double>();
        const Vec3<double> d = random.direction<double>();
        const Vec3<double> expected = d - 2 * d.dot(n) * n;
        const Vec3<float> got = mirror_direction<float>(d.cast<float>(), n.cast<float>());
        errors.add((got.cast<double>() - expected).norm());
    }
    EXPECT_LT(errors.max(), 1e-6);
}

TEST(FuzzyDirection, IsTheMirroredOneWithoutFuzzAndStaysWithinItsCone) {
    RandomInputs random(5);
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> mirrored = random.direction<float>();
        const Vec3<float> on_sphere = random.direction<float>();
        ASSERT_EQ(fuzzy_direction<float>(mirrored, 0.0F, on_sphere), unit<float>(mirrored));
        const float fuzz = static_cast<float>(random.uniform(0, 1));
        const Vec3<float> fuzzy = fuzzy_direction<float>(mirrored, fuzz, on_sphere);
        ASSERT_LT(std::abs(length_error<float>(fuzzy)), kUnit);
        ASSERT_GE(dot<float>(fuzzy, mirrored), std::sqrt(1 - fuzz * fuzz) - 1e-6F);
    }
}

TEST(FuzzyDirection, IsTheMirroredOneWhereFullFuzzCancelsIt) {
    RandomInputs random(6);
    for (int i = 0; i < kInputs / 10; ++i) {
        const Vec3<float> mirrored = random.direction<float>();
        ASSERT_EQ(fuzzy_direction<float>(mirrored, 1.0F, -mirrored), unit<float>(mirrored));
    }
}

/// Fresnel's equations for unpolarised light in long double, at an angle given by the two stored vectors.
long double exact_reflectance(const Vec3<float>& direction, const Vec3<float>& normal, float eta) {
    const auto d = direction.cast<long double>().eval();
    const auto n = normal.cast<long double>().eval();
    const long double cos_in = std::min(-d.dot(n) / std::sqrt(d.dot(d) * n.dot(n)), 1.0L);
    const long double k = 1 - static_cast<long double>(eta) * eta * (1 - cos_in * cos_in);
    if (k < 0) return 1;
    const long double cos_out = std::sqrt(k);
    const long double r_s = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
    const long double r_p = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
    return (r_s * r_s + r_p * r_p) / 2;
}
float schlick(const Vec3<float>& direction, const Vec3<float>& normal, float eta) {
    const float r0 = (1 - eta) / (1 + eta) * ((1 - eta) / (1 + eta));
    return r0 + (1 - r0) * std::pow(1 + dot<float>(direction, normal), 5.0F);
}

/// A ray that arrives at `normal` with its cosine uniform in [low, high].
Vec3<float> arriving(RandomInputs& random, const Vec3<float>& normal, double low, double high) {
    const Vec3<double> n = normal.cast<double>().normalized();
    const Vec3<double> v = random.direction<double>();
    const double cosine = random.uniform(low, high);
    return (std::sqrt(1 - cosine * cosine) * (v - v.dot(n) * n).normalized() - cosine * n).cast<float>();
}

TEST(FresnelSplit, ReflectsByFresnelsEquations) {
    for (const float eta : {1.5F, 1 / 1.5F, 1.33F, 1 / 2.4F}) {
        RandomInputs random(7);
        Errors errors;
        Errors schlick_errors;
        const double critical_cosine = eta > 1 ? std::sqrt(1 - 1 / (eta * eta)) : 0;
        for (int i = 0; i < kInputs / 4; ++i) {
            const Vec3<float> normal = random.direction<float>();
            const Vec3<float> direction = arriving(random, normal, 0, 1);
            const float got = fresnel_split<float>(direction, normal, eta).reflectance;
            ASSERT_TRUE(got >= 0 && got <= 1);
            const long double expected = exact_reflectance(direction, normal, eta);
            // Beside the critical angle, and along the surface, the equations themselves are infinitely steep.
            const double cosine = -direction.cast<double>().dot(normal.cast<double>());
            if (cosine < 1e-3 || std::abs(cosine - critical_cosine) < 1e-3) continue;
            errors.add(got - expected);
            schlick_errors.add(schlick(direction, normal, eta) - expected);
        }
        EXPECT_LT(errors.max(), 2e-5) << eta;
        EXPECT_GT(schlick_errors.max(), 0.03) << eta;
    }
}

TEST(FresnelSplit, RefractsBySnellsLaw) {
    for (const float eta : {1 / 1.5F, 1.5F}) {
        RandomInputs random(8);
        Errors sines;
        Errors lengths;
        for (int i = 0; i < kInputs / 4; ++i) {
            const Vec3<float> normal = random.direction<float>();
            const Vec3<float> direction = arriving(random, normal, eta > 1 ? 0.75 : 0, 1);
            const Vec3<float> refracted = fresnel_split<float>(direction, normal, eta).refracted;
            lengths.add(length_error<float>(refracted));
            const Vec3<double> n = normal.cast<double>();
            sines.add((refracted.cast<double>().cross(n) - eta * direction.cast<double>().cross(n)).norm());
            ASSERT_LT(dot<float>(refracted, normal), 0);
        }
        EXPECT_LT(sines.max(), 1e-6) << eta;
        EXPECT_LT(lengths.max(), kUnit) << eta;
    }
}

TEST(FresnelSplit, MakesNoNotANumberHeadOnWhereTheCosineRoundsAboveOne) {
    RandomInputs random(9);
    int above_one = 0;
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> normal = random.direction<float>();
        const Vec3<float> direction = -normal;
        if (dot<float>(normal, normal) > 1) ++above_one;
        for (const float eta : {1.5F, 1 / 1.5F}) {
            const FresnelSplit<float> split = fresnel_split<float>(direction, normal, eta);
            ASSERT_NEAR(split.reflectance, 0.04F, 1e-6F);
            ASSERT_LT((split.refracted - direction).norm(), 1e-6F);
        }
    }
    EXPECT_GT(above_one, kInputs / 20);
}

TEST(FresnelSplit, DecidesTotalReflectionOnceAtTheCriticalAngle) {
    RandomInputs random(10);
    const double critical_cosine = std::sqrt(1 - 1 / (1.5 * 1.5));
    int total = 0;
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> normal = random.direction<float>();
        const double width = random.one_in(2) ? 1e-7 : 1e-5;
        const Vec3<float> direction = arriving(random, normal, critical_cosine - width, critical_cosine + width);
        const FresnelSplit<float> split = fresnel_split<float>(direction, normal, 1.5F);
        ASSERT_TRUE(split.reflectance > 0.9F && split.reflectance <= 1) << split.reflectance;
        ASSERT_LT(std::abs(length_error<float>(split.refracted)), kUnit);
        if (split.reflectance == 1) ++total;
    }
    EXPECT_GT(total, kInputs / 10);
    EXPECT_LT(total, kInputs - kInputs / 10);
}

TEST(FresnelSplit, StaysFiniteAlongTheSurface) {
    RandomInputs random(11);
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> normal = random.direction<float>();
        const Vec3<float> direction = arriving(random, normal, -1e-7, 1e-6);  // rounding may even turn it around
        for (const float eta : {1.5F, 1 / 1.5F, 10.0F, 0.1F}) {
            const FresnelSplit<float> split = fresnel_split<float>(direction, normal, eta);
            ASSERT_TRUE(split.reflectance >= 0 && split.reflectance <= 1) << split.reflectance;
            ASSERT_LT(std::abs(length_error<float>(split.refracted)), kUnit);
        }
    }
}

TEST(FresnelSplit, LetsLightThroughUnchangedWhereBothSidesAreAlike) {
    RandomInputs random(12);
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> normal = random.direction<float>();
        const Vec3<float> direction = arriving(random, normal, 0, random.one_in(2) ? 1 : 1e-6);
        const FresnelSplit<float> split = fresnel_split<float>(direction, normal, 1.0F);
        ASSERT_EQ(split.reflectance, 0);
        ASSERT_EQ(split.refracted, direction);
    }
}

}  // namespace
}  // namespace raypool::test
