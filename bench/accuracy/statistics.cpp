#include "bench/accuracy/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/base/error.h"

namespace raypool::accuracy {

namespace {

double mean_product(const Values& a, const Values& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum / static_cast<double>(a.size());
}

Values sum_of(const std::vector<Values>& images) {
    Values sum(images.front().size());
    for (const Values& image : images)
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += image[i];
    return sum;
}

}  // namespace

double mean(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

double mean_squared_difference(const Values& a, const Values& b) {
    RAYPOOL_CHECK(a.size() == b.size() && !a.empty(), "images of one size");
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum / static_cast<double>(a.size());
}

Values mean_of(const Halves& halves) {
    Values mean(halves.a.size());
    std::transform(halves.a.begin(), halves.a.end(), halves.b.begin(), mean.begin(),
                   [](double a, double b) { return 0.5 * (a + b); });
    return mean;
}

double noise_of(const Halves& reference) {
    return 0.25 * mean_squared_difference(reference.a, reference.b);
}

double corrected_mse(const Values& image, const Halves& reference) {
    return mean_squared_difference(image, mean_of(reference)) - noise_of(reference);
}

Estimate mean_squared_expectation(const std::vector<Values>& samples) {
    const std::size_t n = samples.size();
    RAYPOOL_CHECK(n >= 2, "two samples make a pair");
    const Values sum = sum_of(samples);
    // Products of pairs, by pair (i, j): those of i with all, and those of i with itself.
    std::vector<double> with_all(n);
    std::vector<double> with_itself(n);
    for (std::size_t i = 0; i < n; ++i) {
        with_all[i] = mean_product(samples[i], sum);
        with_itself[i] = mean_product(samples[i], samples[i]);
    }
    const double all = std::accumulate(with_all.begin(), with_all.end(), 0.0) -
                       std::accumulate(with_itself.begin(), with_itself.end(), 0.0);
    const auto count = static_cast<double>(n);
    const double value = all / (count * (count - 1));
    if (n == 2) return {value, std::abs(value)};

    // Without sample i, its pairs are gone, which were counted in both orders.
    std::vector<double> without(n);
    for (std::size_t i = 0; i < n; ++i)
        without[i] = (all - 2 * (with_all[i] - with_itself[i])) / ((count - 1) * (count - 2));
    const double mean = std::accumulate(without.begin(), without.end(), 0.0) / count;
    double squares = 0;
    for (const double w : without) squares += (w - mean) * (w - mean);
    return {value, std::sqrt(squares * (count - 1) / count)};
}

std::vector<double> variances(const std::vector<Values>& images) {
    const auto n = static_cast<double>(images.size());
    RAYPOOL_CHECK(images.size() >= 2, "two images have a variance");
    const Values sum = sum_of(images);
    std::vector<double> found;
    for (const Values& image : images) {
        double squares = 0;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const double apart = image[i] - (sum[i] - image[i]) / (n - 1);
            squares += apart * apart;
        }
        found.push_back(squares / static_cast<double>(sum.size()) * (n - 1) / n);
    }
    return found;
}

double log_log_slope(std::span<const double> x, std::span<const double> y) {
    const auto n = static_cast<double>(x.size());
    double mean_x = 0;
    double mean_y = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += std::log(x[i]) / n;
        mean_y += std::log(y[i]) / n;
    }
    double xy = 0;
    double xx = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double dx = std::log(x[i]) - mean_x;
        xy += dx * (std::log(y[i]) - mean_y);
        xx += dx * dx;
    }
    return xy / xx;
}

double student_t(std::size_t degrees) {
    constexpr std::array kTable{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                                2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086};
    RAYPOOL_CHECK(degrees >= 1, "a spread needs two values");
    return degrees <= kTable.size() ? kTable[degrees - 1] : 1.96 + 2.5 / static_cast<double>(degrees);
}

}  // namespace raypool::accuracy
