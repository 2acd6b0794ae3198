#include "bench/accuracy/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "core/base/error.h"

namespace raypool::accuracy {

namespace {

Eigen::Map<const Eigen::ArrayXd> array(std::span<const double> values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
}

Eigen::ArrayXd sum_of(const std::vector<Values>& images) {
    Eigen::ArrayXd sum = array(images.front());
    for (std::size_t i = 1; i < images.size(); ++i) sum += array(images[i]);
    return sum;
}

}  // namespace

double mean(std::span<const double> values) {
    return array(values).mean();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

double mean_squared_difference(const Values& a, const Values& b) {
    RAYPOOL_CHECK(a.size() == b.size() && !a.empty(), "images of one size");
    return (array(a) - array(b)).square().mean();
}

Values mean_of(const Halves& halves) {
    const Eigen::ArrayXd mean = 0.5 * (array(halves.a) + array(halves.b));
    return {mean.begin(), mean.end()};
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
    const auto count = static_cast<double>(n);
    const Eigen::ArrayXd sum = sum_of(samples);
    // Products of pairs, by pair (i, j): those of i with all, and those of i with itself.
    Eigen::ArrayXd with_all(n);
    Eigen::ArrayXd with_itself(n);
    for (std::size_t i = 0; i < n; ++i) {
        with_all[static_cast<Eigen::Index>(i)] = (array(samples[i]) * sum).mean();
        with_itself[static_cast<Eigen::Index>(i)] = array(samples[i]).square().mean();
    }
    const double all = with_all.sum() - with_itself.sum();
    const double value = all / (count * (count - 1));
    if (n == 2) return {value, std::abs(value)};

    // Without sample i, its pairs are gone, which were counted in both orders.
    const Eigen::ArrayXd without = (all - 2 * (with_all - with_itself)) / ((count - 1) * (count - 2));
    return {value, std::sqrt((without - without.mean()).square().sum() * (count - 1) / count)};
}

std::vector<double> variances(const std::vector<Values>& images) {
    const auto n = static_cast<double>(images.size());
    RAYPOOL_CHECK(images.size() >= 2, "two images have a variance");
    const Eigen::ArrayXd sum = sum_of(images);
    std::vector<double> found;
    for (const Values& image : images)
        found.push_back((array(image) - (sum - array(image)) / (n - 1)).square().mean() * (n - 1) / n);
    return found;
}

double log_log_slope(std::span<const double> x, std::span<const double> y) {
    const Eigen::ArrayXd log_x = array(x).log();
    const Eigen::ArrayXd log_y = array(y).log();
    const Eigen::ArrayXd dx = log_x - log_x.mean();
    return (dx * (log_y - log_y.mean())).sum() / dx.square().sum();
}

double student_t(std::size_t degrees) {
    constexpr std::array kTable{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                                2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086};
    RAYPOOL_CHECK(degrees >= 1, "a spread needs two values");
    return degrees <= kTable.size() ? kTable[degrees - 1] : 1.96 + 2.5 / static_cast<double>(degrees);
}

}  // namespace raypool::accuracy
