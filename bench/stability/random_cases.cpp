// Row 7: random numbers. Neighbouring pixels must not know of each other, and threads must not be seen; and how fast
// the error falls with the samples of a pixel.

#include <array>
#include <cmath>
#include <numbers>

#include "bench/naive/random.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/math/random.h"

namespace raypool::stability {

namespace {

float our_first(std::uint32_t pixel) {
    return random_block<float>({pixel, 0}, 0, RandomPurpose::Film, random_seed(0))[0];
}

/// Correlation of the first numbers of seeds that are so far apart.
template <float (*first)(std::uint32_t)>
double correlation(double apart, std::int64_t seeds) {
    const auto distance = static_cast<std::uint32_t>(apart);
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (std::uint32_t seed = 1; seed <= static_cast<std::uint32_t>(seeds); ++seed) {
        const double a = static_cast<double>(first(seed));
        const double b = static_cast<double>(first(seed + distance));
        x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
    }
    const double n = static_cast<double>(seeds);
    return std::abs((xy - x * y / n) / std::sqrt((xx - x * x / n) * (yy - y * y / n)));
}

/// An image of 32 x 32 whose lines threads share as OpenMP's static schedule does: what a pixel's mean of 16 numbers
/// is. Pixels that differ from the image of one thread.
template <bool is_keyed>
std::vector<float> image_of(int threads) {
    constexpr int kEdge = 32;
    std::vector<float> image;
    for (int thread = 0; thread < threads; ++thread) {
        naive::ThreadGenerator generator(static_cast<std::uint64_t>(thread));
        for (int pixel = kEdge * thread / threads * kEdge; pixel < kEdge * (thread + 1) / threads * kEdge; ++pixel) {
            float sum = 0;
            for (std::uint32_t sample = 0; sample < 16; ++sample) {
                sum += is_keyed ? random_block<float>({static_cast<std::uint32_t>(pixel), sample}, 0,
                                                      RandomPurpose::Film, random_seed(0))[0]
                                : generator.next();
            }
            image.push_back(sum);
        }
    }
    return image;
}
template <bool is_keyed>
double changed_pixels(double threads, std::int64_t) {
    const std::vector<float> one = image_of<is_keyed>(1);
    const std::vector<float> many = image_of<is_keyed>(static_cast<int>(threads));
    std::int64_t changed = 0;
    for (std::size_t i = 0; i < one.size(); ++i) changed += one[i] != many[i] ? 1 : 0;
    return share(changed, static_cast<std::int64_t>(one.size()));
}

/// A number of the integral over the square (0: smooth; 1: a disc's edge) or over six dimensions in two blocks (2: the
/// share of the cube below a plane).
double integrand(int which, std::uint32_t pixel, std::uint32_t sample, const RandomSeed& seed) {
    const std::array<float, 4> a = random_block<float>({pixel, sample}, 0, RandomPurpose::Film, seed);
    if (which == 0) return std::exp(static_cast<double>(a[0])) * std::cos(static_cast<double>(a[1]));
    if (which == 1) return a[0] * a[0] + a[1] * a[1] < 0.5F ? 1 : 0;
    const std::array<float, 4> b = random_block<float>({pixel, sample}, 0, RandomPurpose::Scatter, seed);
    return a[0] + a[1] + a[2] + a[3] + b[0] + b[1] < 3 ? 1 : 0;
}
constexpr double kIntegrals[] = {(std::numbers::e - 1) * 0.8414709848078965, std::numbers::pi / 8, 0.5};

/// What is left of the RMSE when a pixel gets four times the samples: 4 to the slope fitted from 16 to 4096 of them.
template <Sampler sampler>
double left_of_error(double which, std::int64_t) {
    constexpr std::uint32_t kPixels = 200;
    constexpr std::uint32_t kMost = 4096;
    const int f = static_cast<int>(which);
    const RandomSeed seed = random_seed(1, sampler);
    std::array<double, 5> squares{};
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        double sum = 0;
        std::size_t level = 0;
        for (std::uint32_t i = 0; i < kMost; ++i) {
            sum += integrand(f, pixel, i, seed);
            if (i + 1 == 16U << (2 * level)) squares[level++] += std::pow(sum / (i + 1) - kIntegrals[f], 2);
        }
    }
    double slope = 0;  // least squares at -2, -1, 0, 1, 2
    for (int level = 0; level < 5; ++level) slope += (level - 2) * std::log2(squares[level]) / 2 / 10;
    return std::exp2(slope);
}

template <float (*first)(std::uint32_t)>
double time_first(std::int64_t calls) {
    double sum = 0;
    for (std::int64_t i = 0; i < calls; ++i) sum += static_cast<double>(first(static_cast<std::uint32_t>(i)));
    return sum;
}
/// Four numbers a call.
double time_block(std::int64_t calls) {
    double sum = 0;
    for (std::int64_t i = 0; i < calls / 4; ++i)
        for (const float x :
             random_block<float>({static_cast<std::uint32_t>(i), 0}, 0, RandomPurpose::Film, random_seed(0)))
            sum += static_cast<double>(x);
    return sum;
}

}  // namespace

std::vector<Case> random_cases() {
    std::vector<Case> cases;
    cases.push_back({.id = "neighbouring-seeds",
                     .row = "7a",
                     .parameter = "distance of two seeds",
                     .values = {1024, 256, 64, 16, 4, 1},
                     .measure = "correlation of their first numbers, absolute",
                     .tolerance = 0.02,
                     .symptom = "stripes and patterns in place of noise",
                     .samples = 400'000,
                     .methods = {{"minstd, seeded by the pixel", Kind::Naive, correlation<naive::minstd_first>,
                                  time_first<naive::minstd_first>},
                                 {"xorshift32, seeded by the pixel", Kind::Naive, correlation<naive::xorshift_first>,
                                  time_first<naive::xorshift_first>},
                                 {"ours, pcg4d", Kind::Ours, correlation<our_first>, time_block}}});
    cases.push_back({.id = "seeds-by-thread",
                     .row = "7a",
                     .parameter = "threads",
                     .values = {2, 3, 4, 7, 8},
                     .measure = "pixels that differ from one thread's, share",
                     .tolerance = 0,
                     .symptom = "the image depends on the number of threads",
                     .methods = {{"a generator a thread", Kind::Naive, changed_pixels<false>},
                                 {"ours, keyed by pixel and sample", Kind::Ours, changed_pixels<true>}}});
    cases.push_back({.id = "error-slope",
                     .row = "7b",
                     .parameter = "what is integrated: 0 smooth, 1 an edge, 2 an edge in six dimensions",
                     .values = {0, 1, 2},
                     .measure = "RMSE left by four times the samples, part",
                     .tolerance = 0.41,
                     .symptom = "noise that falls no faster than the square root of the samples",
                     .methods = {{"independent", Kind::Naive, left_of_error<Sampler::Independent>},
                                 {"ours, Owen-scrambled Sobol", Kind::Ours, left_of_error<Sampler::Sobol>}},
                     .held = 2,
                     .limit = "points in many dimensions are padded from points in four, and gain only a factor"});
    return cases;
}

}  // namespace raypool::stability
