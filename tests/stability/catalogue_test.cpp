/// The sharp points of the rows, with their figures: what naive methods get wrong there, and that ours does not.
#include <gtest/gtest.h>

#include "bench/stability/case.h"

namespace raypool::stability {
namespace {

struct Point {
    const char* id;
    const char* method;
    double value;
    double least, most;  ///< what the error must be between
};
void PrintTo(const Point& point, std::ostream* out) {
    *out << point.id << ", " << point.method << " at " << point.value;
}

// Naive methods: within a factor or so of what was measured, so that a case that has become tame fails.
const Point kPoints[] = {
    {"far-sphere", "half-b, float", 1e3, 0.005, 0.05},
    {"far-sphere", "half-b, float", 1e4, 0.1, 0.6},
    {"far-sphere", "intervals that reject, float", 1e4, 0.4, 0.6},
    {"far-sphere", "ours, float", 1e3, 0, 0},
    {"far-sphere", "ours, float", 1e4, 0, 2e-4},
    {"far-sphere-distance", "ours, float", 1e3, 0, 4e-7},
    {"grazing", "half-b, float", 1e-6, 0.1, 0.3},
    {"grazing", "intervals that reject, float", 1e-6, 0.9, 1},
    {"grazing", "ours, float", 1e-6, 0, 0},
    {"grazing-distance", "ours, float", 1e-6, 0, 2.4e-5},
    {"grazing-distance", "ours, double on float", 1e-6, 0, 1e-7},
    {"ground-sphere", "half-b, float", 1e6, 1e-3, 1e-2},
    {"ground-sphere", "Haines with f.f - r^2, float", 1e6, 1e-4, 2e-3},
    {"ground-sphere", "ours, float", 1e6, 0, 1e-5},
    {"ground-sphere", "ours, double on float", 1e6, 0, 5e-8},
    {"reprojection", "half-b, along the ray, float", 1e2, 5e-4, 3e-3},
    {"reprojection", "ours, along the ray, float", 1e2, 5e-6, 3e-5},
    {"reprojection", "ours, float", 1e2, 0, 1.3e-7},
    {"reprojection-ground", "always reprojected, float", 1e3, 6e-8, 2e-7},
    {"reprojection-ground", "ours, float", 1e3, 0, 2e-8},
    {"far-sphere-double", "half-b, double", 1e7, 1e-3, 2e-2},
    {"far-sphere-normal", "half-b, double", 1e7, 0.03, 0.2},
    {"far-sphere-normal", "ours, double", 1e7, 0, 3.5e-9},
    {"acne-far", "least distance 1e-3, float", 1e4, 2e-3, 0.08},
    {"acne-far", "least distance 1e-3, float", 1e6, 0.3, 0.6},
    {"acne-far", "ours, float", 1e5, 0, 0},
    {"acne-far", "offset origin, float", 1e4, 0, 0},
    {"acne-large", "least distance 0, float", 1e3, 0.2, 0.6},
    {"far-side", "least distance 1e-3, float", 1e-4, 1, 1},
    {"leak", "least distance 1e-3, float", 1e-3, 0.05, 0.3},
    {"leak", "least distance 1e-3, float", 1e-4, 1, 1},
    {"furnace-far", "least distance 1e-3, float", 1e4, 0.2, 0.9},
    {"furnace-far", "ours, float", 1e4, 0, 2e-6},
    {"flat-box", "max <= min misses, float", 0, 0.3, 0.7},
    {"flat-box", "max <= min misses, float", 1, 0.7, 0.95},
    {"box-edge", "ordered, no slack, float", 10, 0.01, 0.3},
    {"box-edge", "fused, no slack, float", 10, 0.04, 0.4},
    {"sphere-pole", "centre -+ radius, rounded, float", 1, 0.01, 0.6},
    {"sphere-pole", "the same with our slack, float", 1, 0.01, 0.6},
    {"still-sphere", "(1 - t) a + t b, float", 1, 0.03, 0.1},
    {"moving-box", "box between two boxes, float", 1, 0.01, 1},
    {"diffuse-cancels", "no guard, float", 0, 1, 1},
    {"unit-vector", "scaled by the greatest first, float", 23, 0, 1.5e-7},
    {"unit-vector", "ours, float", 23, 1, 1},
    {"head-on", "cosine as it comes, float", 1e-8, 0.01, 0.4},
    {"critical-angle", "sine test and another root, float", 1e-5, 1e-3, 1e-2},
    {"critical-angle", "sine test and another root, float", 1e-7, 0.2, 0.5},
    {"reflectance-entering", "Schlick, float", 0.1, 0.03, 0.04},
    {"reflectance-leaving", "Schlick, float", 0.6, 0.9, 1},
    {"index-one", "Fresnel without a rule for it, float", 1e-4, 0.5, 1},
    {"fuzz-below-0.3", "what is absorbed", 85, 0.33, 0.38},
    {"fuzz-below-1", "what is absorbed", 75, 0.35, 0.4},
    {"below-one", "word / 2^32, float", 128, 1, 1},
    {"below-one", "word / 2^32, float", 512, 0.2, 0.3},
    {"depth-limit", "a limit that nobody mentions", 50, 0.6, 0.61},
    {"depth-limit", "a limit that nobody mentions", 125, 0.28, 0.29},
    {"roulette", "min(0.95, throughput), float", 1e5, 4, 1e3},
    {"error-slope", "independent", 0, 0.435, 0.575},                 // slope -0.5 +- 0.1
    {"error-slope", "independent", 1, 0.435, 0.575},                 // the same
    {"error-slope", "ours, Owen-scrambled Sobol", 0, 0.12, 0.158},   // slope -1.43 +- 0.1
    {"error-slope", "ours, Owen-scrambled Sobol", 1, 0.312, 0.412},  // slope -0.74 +- 0.1
    {"error-slope", "ours, Owen-scrambled Sobol", 2, 0.406, 0.575},  // slope -0.525 +- 0.125
    {"direction-drift", "not made unit again, float", 1e6, 1e-3, 0.2},
    {"constant-sum", "float", 5e7, 0.5, 0.6},
    {"dark-scene", "fixed point at 2^-24", 1e-8, 1, 1},
    {"bad-samples", "fixed point, converted blindly", 1, 1e6, 1e12},
    {"neighbouring-seeds", "minstd, seeded by the pixel", 1, 0.99, 1.0001},
    {"neighbouring-seeds", "xorshift32, seeded by the pixel", 1, 0.99, 1.0001},
    {"seeds-by-thread", "a generator a thread", 2, 0.42, 0.61},
    {"checker-below-zero", "(int) truncation, float", 10, 0.5, 1},
    {"checker", "floor, float", 1e5, 5e-3, 0.05},
    {"checker", "floor, float", 1e6, 0.05, 0.3},
    {"checker-in-plane", "3-D checker, y = 0 a boundary", 10, 0.4, 0.6},
    {"large-image", "int32", 65'536, 0.4, 0.6},
    {"pixel-jitter", "pixel + jitter, float", 65'536, 1e-3, 4e-3},
    {"splitting", "all branches at once", 7, 128, 128},
    {"quad-seam", "ours, float", 1e3, 0, 0},
    {"black-image", "a running sum divided by its last, float", 0, 1, 1},
    {"black-image", "the first sum not below the number, float", 1, 0x1p-24, 0x1p-24},
    {"lit-square", "radiance between texels, density by texel, float", 1, 0.4, 0.475},  // 7 / 16
    {"one-colour", "by the sine of a texel's middle, float", 1, 0.3633, 0.3635},        // 1 - 2 / pi
    {"one-colour-floor", "even angles in a texel, float", 1, 0.26, 0.29},               // 4 / pi - 1
    {"sun-share", "a running sum of all texels, float", 1024, 0.005, 0.05},
    {"sun-share", "a running sum of all texels, double", 1024, 0.005, 0.05},
    {"sun-height", "a density without the sine, float", 90, 0.355, 0.365},  // 1 - 2 / pi
    {"sky-pole", "arc cosine of the height, float", 16384, 0.2, 0.4},
    {"sky-seam", "a turn added below 0, float", 1e-7, 0.45, 0.55},
    {"sun-edge", "looked up by the direction, float", 1024, 1e-4, 1e-3},
};

class SharpPoint : public testing::TestWithParam<Point> {};
TEST_P(SharpPoint, IsAsMeasured) {
    const Point& point = GetParam();
    const Case& one = find_case(point.id);
    const double error = one.method(point.method).error(point.value, one.samples / 10);
    EXPECT_GE(error, point.least);
    EXPECT_LE(error, point.most);
}
INSTANTIATE_TEST_SUITE_P(Stability, SharpPoint, testing::ValuesIn(kPoints));

}  // namespace
}  // namespace raypool::stability
