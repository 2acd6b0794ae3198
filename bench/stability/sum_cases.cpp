// Rows 6a to 6d: sums that are long, in another order, very small, or of numbers that are none.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "bench/naive/sums.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/film/framebuffer.h"

namespace raypool::stability {

namespace {

/// The framebuffer's way: a step for so many terms of at most that size, and integers.
class OurSum {
  public:
    explicit OurSum(std::int64_t terms, double greatest = 1)
        : fixed_(FixedPoint::make(terms, greatest)), converter_(fixed_) {}
    void add(float x) { sum_ += converter_.convert<float>(vec3<float>(x, 0, 0))[0]; }
    [[nodiscard]] double value() const { return static_cast<double>(sum_) / fixed_.scale(); }
    [[nodiscard]] std::int64_t left_out() const { return converter_.statistics().non_finite; }

  private:
    FixedPoint fixed_;
    SampleConverter converter_;
    std::int64_t sum_ = 0;
};

template <class Sum>
Sum make_sum(std::int64_t terms, double greatest) {
    if constexpr (std::same_as<Sum, OurSum>) {
        return OurSum(terms, greatest);
    } else {
        return {};
    }
}

/// The same number again and again: it is known what comes out.
template <class Sum>
double constant_sum(double terms, std::int64_t) {
    const auto count = static_cast<std::int64_t>(terms);
    constexpr float kTerm = 0.73F;
    Sum sum = make_sum<Sum>(count, 1);
    for (std::int64_t i = 0; i < count; ++i) sum.add(kTerm);
    return std::abs(sum.value() / (terms * static_cast<double>(kTerm)) - 1);
}

/// Numbers in [0, 1), against the same in 128-bit integers.
template <class Sum>
double random_sum(double terms, std::int64_t) {
    RandomInputs random(71);
    const auto count = static_cast<std::int64_t>(terms);
    Sum sum = make_sum<Sum>(count, 1);
    std::int64_t exact = 0;  // of multiples of 2^-24
    for (std::int64_t i = 0; i < count; ++i) {
        const auto word = static_cast<std::int64_t>(random.bits() >> 40U);
        exact += word;
        sum.add(static_cast<float>(word) * 0x1p-24F);
    }
    return std::abs(sum.value() / (static_cast<double>(exact) * 0x1p-24) - 1);
}

/// Radiance with a heavy tail, in 30 orders: the greatest sum less the least, over the mean.
constexpr float kBrightest = 1e4F;
template <class Sum>
double order_spread(double terms, std::int64_t) {
    RandomInputs random(72);
    std::vector<float> radiance(static_cast<std::size_t>(terms));
    for (float& x : radiance) {
        const float u = random.unit_interval<float>() + 0x1p-24F;
        x = std::min(kBrightest, 1e-5F / (u * u));
    }
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (int order = 0; order < 30; ++order) {
        for (std::size_t i = radiance.size(); i > 1; --i)
            std::swap(radiance[i - 1], radiance[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
        Sum sum = make_sum<Sum>(static_cast<std::int64_t>(terms), kBrightest);
        for (const float x : radiance) sum.add(x);
        low = std::min(low, sum.value());
        high = std::max(high, sum.value());
    }
    return (high - low) / (0.5 * (high + low));
}

/// A scene as dark as that, 1000 samples: relative error of the mean.
template <class Sum>
double dark_mean(double radiance, std::int64_t) {
    constexpr std::int64_t kTerms = 1000;
    const auto x = static_cast<float>(radiance);
    Sum sum = make_sum<Sum>(kTerms, 1);
    for (std::int64_t i = 0; i < kTerms; ++i) sum.add(x);
    return std::abs(sum.value() / kTerms / static_cast<double>(x) - 1);
}

/// A thousand samples of 0.5, so many of them not finite: how far the mean of the good ones is off.
template <class Sum>
double bad_mean(double bad, std::int64_t) {
    constexpr std::int64_t kTerms = 1000;
    const auto bad_count = static_cast<std::int64_t>(bad);
    Sum sum = make_sum<Sum>(kTerms, 1);
    for (std::int64_t i = 0; i < kTerms; ++i) {
        const float none = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : kInfinity<float>;
        sum.add(i < bad_count ? none : 0.5F);
    }
    std::int64_t left_out = 0;
    if constexpr (std::same_as<Sum, OurSum>) left_out = sum.left_out();
    const double good = static_cast<double>(kTerms - left_out);
    const double error = std::abs(sum.value() / good / 0.5 - 1);
    return std::isnan(error) ? 1e18 : std::min(error, 1e18);  // an error there is, whatever a NaN says
}

template <class Sum>
double time_sum(std::int64_t calls) {
    Sum sum = make_sum<Sum>(calls, 1);
    for (std::int64_t i = 0; i < calls; ++i) sum.add(static_cast<float>(i & 255) * 0x1p-8F);
    return sum.value();
}
double time_float_exchange(std::int64_t calls) {
    std::atomic<float> sum = 0;
    for (std::int64_t i = 0; i < calls; ++i) {
        float seen = sum.load(std::memory_order_relaxed);
        while (!sum.compare_exchange_weak(seen, seen + static_cast<float>(i & 255) * 0x1p-8F)) {
        }
    }
    return static_cast<double>(sum.load());
}
double time_fetch_add(std::int64_t calls) {
    std::atomic<std::int64_t> sum = 0;
    for (std::int64_t i = 0; i < calls; ++i) sum.fetch_add(i & 255, std::memory_order_relaxed);
    return static_cast<double>(sum.load());
}

}  // namespace

std::vector<Case> sum_cases() {
    using naive::BlindFixedSum;
    using naive::BlockSum;
    using naive::NeumaierSum;
    using naive::PlainSum;
    std::vector<Case> cases;
    cases.push_back(
        {.id = "constant-sum",
         .row = "6a",
         .parameter = "terms",
         .values = {1e4, 1e5, 1e6, 1e7, 5e7},
         .measure = "sum of the same number, relative error",
         .tolerance = 1e-7,
         .symptom = "the image stops getting brighter, and then gets darker with every sample",
         .methods = {{"float", Kind::Naive, constant_sum<PlainSum<float>>, time_sum<PlainSum<float>>},
                     {"float, Neumaier", Kind::Naive, constant_sum<NeumaierSum>, time_sum<NeumaierSum>},
                     {"float blocks of 64 in double", Kind::Alternative, constant_sum<BlockSum>},
                     {"double", Kind::Alternative, constant_sum<PlainSum<double>>, time_sum<PlainSum<double>>},
                     {"ours, int64", Kind::Ours, constant_sum<OurSum>, time_sum<OurSum>}}});
    cases.push_back({.id = "random-sum",
                     .row = "6a",
                     .parameter = "terms",
                     .values = {1e4, 1e5, 1e6, 1e7, 1e8},
                     .measure = "sum of random numbers below 1, relative error",
                     .tolerance = 1e-7,
                     .symptom = "bright pixels stay too dark, the longer the render the more",
                     .methods = {{"float", Kind::Naive, random_sum<PlainSum<float>>},
                                 {"float, Neumaier", Kind::Naive, random_sum<NeumaierSum>},
                                 {"float blocks of 64 in double", Kind::Alternative, random_sum<BlockSum>},
                                 {"double", Kind::Alternative, random_sum<PlainSum<double>>},
                                 {"ours, int64", Kind::Ours, random_sum<OurSum>}}});
    cases.push_back({.id = "order-of-sum",
                     .row = "6b",
                     .parameter = "terms, with a heavy tail",
                     .values = {1e2, 1e3, 1e4, 1e5, 3e5},
                     .measure = "spread of the sum over 30 orders, relative",
                     .tolerance = 0,
                     .symptom = "the image depends on the number of threads and on luck",
                     .methods = {{"float, any order", Kind::Naive, order_spread<PlainSum<float>>, time_float_exchange},
                                 {"double, any order", Kind::Naive, order_spread<PlainSum<double>>},
                                 {"ours, int64", Kind::Ours, order_spread<OurSum>, time_fetch_add}}});
    cases.push_back({.id = "dark-scene",
                     .row = "6c",
                     .parameter = "radiance of the brightest pixel's scene, of 1",
                     .values = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10},
                     .measure = "mean of 1000 samples, relative error",
                     .tolerance = 1e-4,
                     .symptom = "dark corners are black",
                     .methods = {{"fixed point at 2^-24", Kind::Naive, dark_mean<BlindFixedSum>},
                                 {"ours, int64", Kind::Ours, dark_mean<OurSum>}}});
    cases.push_back({.id = "bad-samples",
                     .row = "6c",
                     .parameter = "samples of 1000 that are not finite",
                     .values = {1, 2, 10, 100},
                     .measure = "mean of the good samples, relative error",
                     .tolerance = 1e-6,
                     .symptom = "one bad sample destroys its pixel: black, white or a huge number",
                     .methods = {{"float", Kind::Naive, bad_mean<PlainSum<float>>},
                                 {"fixed point, converted blindly", Kind::Naive, bad_mean<BlindFixedSum>},
                                 {"ours, int64", Kind::Ours, bad_mean<OurSum>}}});
    return cases;
}

}  // namespace raypool::stability
