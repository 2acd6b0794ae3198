// Row 7: random numbers. Neighbouring pixels must not know of each other, and threads must not be seen; and how fast
// the error falls with the samples of a pixel.

#include <array>
#include <cmath>
#include <numbers>

#include "bench/naive/random.h"
#include "bench/stability/case.h"
#include "bench/stability/methods.h"
#include "core/math/random.h"

namespace raypool::stability {

namespace {

float our_first(std::uint32_t pixel) {
    return random_block<float>({pixel, 0}, 0, RandomPurpose::Film, random_seed(0))[0];
}

/// Correlation of the first numbers of seeds that are so far apart.
constexpr auto kCorrelation = []<class>(const auto& first, double apart, std::int64_t seeds) {
    const auto distance = static_cast<std::uint32_t>(apart);
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (std::uint32_t seed = 1; seed <= static_cast<std::uint32_t>(seeds); ++seed) {
        const double a = static_cast<double>(first(seed));
        const double b = static_cast<double>(first(seed + distance));
        x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
    }
    const double n = static_cast<double>(seeds);
    return std::abs((xy - x * y / n) / std::sqrt((xx - x * x / n) * (yy - y * y / n)));
};

// Ways to draw a sample of a pixel, where a thread has a generator.
constexpr auto kByThread = [](naive::ThreadGenerator& generator, std::uint32_t, std::uint32_t) {
    return generator.next();
};
constexpr auto kKeyed = [](naive::ThreadGenerator&, std::uint32_t pixel, std::uint32_t sample) {
    return random_block<float>({pixel, sample}, 0, RandomPurpose::Film, random_seed(0))[0];
};
/// An image of 32 x 32 whose lines threads share as OpenMP's static schedule does: what a pixel's sum of 16 numbers is.
std::vector<float> image_of(const auto& draw, int threads) {
    constexpr int kEdge = 32;
    std::vector<float> image;
    for (int thread = 0; thread < threads; ++thread) {
        naive::ThreadGenerator generator(static_cast<std::uint64_t>(thread));
        for (int pixel = kEdge * thread / threads * kEdge; pixel < kEdge * (thread + 1) / threads * kEdge; ++pixel) {
            float sum = 0;
            for (std::uint32_t sample = 0; sample < 16; ++sample)
                sum += draw(generator, static_cast<std::uint32_t>(pixel), sample);
            image.push_back(sum);
        }
    }
    return image;
}
/// Pixels that differ from the image of one thread.
constexpr auto kChangedPixels = []<class>(const auto& draw, double threads, std::int64_t) {
    const std::vector<float> one = image_of(draw, 1);
    const std::vector<float> many = image_of(draw, static_cast<int>(threads));
    std::size_t pixel = 0;
    return share_of(static_cast<std::int64_t>(one.size()), RandomInputs(0), [&](RandomInputs&) {
        const bool is_changed = one[pixel] != many[pixel];
        ++pixel;
        return is_changed;
    });
};

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
constexpr auto kLeftOfError = []<class>(Sampler sampler, double which, std::int64_t) {
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
};

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

CaseMethods random_cases() {
    return {{"neighbouring-seeds",
             Methods(kCorrelation)
                 .naive("minstd, seeded by the pixel", naive::minstd_first, time_first<naive::minstd_first>)
                 .naive("xorshift32, seeded by the pixel", naive::xorshift_first, time_first<naive::xorshift_first>)
                 .ours("ours, pcg4d", our_first, time_block)},
            {"seeds-by-thread", Methods(kChangedPixels)
                                    .naive("a generator a thread", kByThread)
                                    .ours("ours, keyed by pixel and sample", kKeyed)},
            {"error-slope", Methods(kLeftOfError)
                                .naive("independent", Sampler::Independent)
                                .ours("ours, Owen-scrambled Sobol", Sampler::Sobol)}};
}

}  // namespace raypool::stability
