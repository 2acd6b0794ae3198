// Rows 6a to 6d: sums that are long, in another order, very small, or of numbers that are none.

#include <algorithm>
#include <atomic>
#include <cmath>

#include "bench/stability/case.h"
#include "bench/stability/methods.h"
#include "core/film/framebuffer.h"

namespace raypool::stability {

namespace {

// Sums that round.
template <class Scalar>
struct PlainSum {
    Scalar sum = 0;
    void add(float x) { sum += static_cast<Scalar>(x); }
    [[nodiscard]] double value() const { return static_cast<double>(sum); }
};

/// Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen", 1974. In float the compensation
/// itself stops growing.
struct NeumaierSum {
    float sum = 0;
    float compensation = 0;
    void add(float x) {
        const float next = sum + x;
        compensation += std::fabs(sum) >= std::fabs(x) ? (sum - next) + x : (x - next) + sum;
        sum = next;
    }
    [[nodiscard]] double value() const { return static_cast<double>(sum + compensation); }
};

/// Blocks of 64 in float, added up in double.
struct BlockSum {
    double sum = 0;
    float block = 0;
    int count = 0;
    void add(float x) {
        block += x;
        if (++count == 64) {
            sum += static_cast<double>(block);
            block = 0;
            count = 0;
        }
    }
    [[nodiscard]] double value() const { return sum + static_cast<double>(block); }
};

/// Fixed point with a step that does not look at the scene, converted without looking at the number. What the processor
/// makes of a number out of range, NaN too, is the least integer; in C++ it is undefined, so it is spelled out here.
struct BlindFixedSum {
    std::int64_t sum = 0;
    static constexpr double kScale = 0x1p24;
    void add(float x) {
        const double scaled = static_cast<double>(x) * kScale;
        const bool is_in_range = std::fabs(scaled) < 0x1p63;
        const std::int64_t fixed = is_in_range ? std::llrint(scaled) : std::numeric_limits<std::int64_t>::min();
        sum = static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) + static_cast<std::uint64_t>(fixed));
    }
    [[nodiscard]] double value() const { return static_cast<double>(sum) / kScale; }
};

/// The framebuffer's way: a step for so many terms of at most that size, and integers.
class FixedSum {
  public:
    FixedSum(std::int64_t terms, double greatest) : fixed_(FixedPoint::make(terms, greatest)), converter_(fixed_) {}
    void add(float x) { sum_ += converter_.convert<float>(vec3<float>(x, 0, 0))[0]; }
    [[nodiscard]] double value() const { return static_cast<double>(sum_) / fixed_.scale(); }
    [[nodiscard]] std::int64_t left_out() const { return converter_.statistics().non_finite; }

  private:
    FixedPoint fixed_;
    SampleConverter converter_;
    std::int64_t sum_ = 0;
};

// Ways to begin a sum of so many terms of at most that size.
template <class Sum>
constexpr auto kNaive = [](std::int64_t, double) { return Sum{}; };
constexpr auto kOurs = [](std::int64_t terms, double greatest) { return FixedSum(terms, greatest); };

/// The same number again and again: it is known what comes out.
double sum_of_equal_terms(const auto& begin, std::int64_t terms, float x) {
    auto sum = begin(terms, 1);
    for (std::int64_t i = 0; i < terms; ++i) sum.add(x);
    return sum.value();
}
constexpr auto kConstantSum = []<class>(const auto& begin, double terms, std::int64_t) {
    constexpr float kTerm = 0.73F;
    const double sum = sum_of_equal_terms(begin, static_cast<std::int64_t>(terms), kTerm);
    return std::abs(sum / (terms * static_cast<double>(kTerm)) - 1);
};
/// A scene as dark as that, 1000 samples: relative error of the mean.
constexpr auto kDarkMean = []<class>(const auto& begin, double radiance, std::int64_t) {
    const auto x = static_cast<float>(radiance);
    return std::abs(sum_of_equal_terms(begin, 1000, x) / 1000 / static_cast<double>(x) - 1);
};

/// Numbers in [0, 1), against the same in 128-bit integers.
constexpr auto kRandomSum = []<class>(const auto& begin, double terms, std::int64_t) {
    RandomInputs random(71);
    const auto count = static_cast<std::int64_t>(terms);
    auto sum = begin(count, 1);
    std::int64_t exact = 0;  // of multiples of 2^-24
    for (std::int64_t i = 0; i < count; ++i) {
        const auto word = static_cast<std::int64_t>(random.bits() >> 40U);
        exact += word;
        sum.add(static_cast<float>(word) * 0x1p-24F);
    }
    return std::abs(sum.value() / (static_cast<double>(exact) * 0x1p-24) - 1);
};

/// Radiance with a heavy tail, in 30 orders: the greatest sum less the least, over the mean.
constexpr auto kOrderSpread = []<class>(const auto& begin, double terms, std::int64_t) {
    constexpr float kBrightest = 1e4F;
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
        auto sum = begin(static_cast<std::int64_t>(terms), static_cast<double>(kBrightest));
        for (const float x : radiance) sum.add(x);
        low = std::min(low, sum.value());
        high = std::max(high, sum.value());
    }
    return (high - low) / (0.5 * (high + low));
};

/// A thousand samples of 0.5, so many of them not finite: how far the mean of the good ones is off.
constexpr auto kBadMean = []<class>(const auto& begin, double bad, std::int64_t) {
    constexpr std::int64_t kTerms = 1000;
    const auto bad_count = static_cast<std::int64_t>(bad);
    auto sum = begin(kTerms, 1);
    for (std::int64_t i = 0; i < kTerms; ++i) {
        const float none = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : kInfinity<float>;
        sum.add(i < bad_count ? none : 0.5F);
    }
    std::int64_t left_out = 0;
    if constexpr (std::same_as<decltype(sum), FixedSum>) left_out = sum.left_out();
    const double good = static_cast<double>(kTerms - left_out);
    const double error = std::abs(sum.value() / good / 0.5 - 1);
    return std::isnan(error) ? 1e18 : std::min(error, 1e18);  // an error there is, whatever a NaN says
};

template <class Begin>
auto timed(Begin begin) {
    return [begin](std::int64_t calls) {
        auto sum = begin(calls, 1);
        for (std::int64_t i = 0; i < calls; ++i) sum.add(static_cast<float>(i & 255) * 0x1p-8F);
        return sum.value();
    };
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

CaseMethods sum_cases() {
    constexpr auto kFloat = kNaive<PlainSum<float>>;
    constexpr auto kDouble = kNaive<PlainSum<double>>;
    constexpr auto kNeumaier = kNaive<NeumaierSum>;
    constexpr auto kBlocks = kNaive<BlockSum>;
    constexpr auto kBlind = kNaive<BlindFixedSum>;
    return {{"constant-sum", Methods(kConstantSum)
                                 .naive("float", kFloat, timed(kFloat))
                                 .naive("float, Neumaier", kNeumaier, timed(kNeumaier))
                                 .other("float blocks of 64 in double", kBlocks)
                                 .other("double", kDouble, timed(kDouble))
                                 .ours("ours, int64", kOurs, timed(kOurs))},
            {"random-sum", Methods(kRandomSum)
                               .naive("float", kFloat)
                               .naive("float, Neumaier", kNeumaier)
                               .other("float blocks of 64 in double", kBlocks)
                               .other("double", kDouble)
                               .ours("ours, int64", kOurs)},
            {"order-of-sum", Methods(kOrderSpread)
                                 .naive("float, any order", kFloat, time_float_exchange)
                                 .naive("double, any order", kDouble)
                                 .ours("ours, int64", kOurs, time_fetch_add)},
            {"dark-scene", Methods(kDarkMean).naive("fixed point at 2^-24", kBlind).ours("ours, int64", kOurs)},
            {"bad-samples", Methods(kBadMean)
                                .naive("float", kFloat)
                                .naive("fixed point, converted blindly", kBlind)
                                .ours("ours, int64", kOurs)}};
}

}  // namespace raypool::stability
