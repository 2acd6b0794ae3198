/// Statistics of error against time: pure functions over numbers, known to tests by data whose truth is known.
///
/// Called by the study of speed and accuracy and by `raypool advise`. Errors are of linear radiance; an image is its
/// channel means in row order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raypool::accuracy {

/// Channel values of an image: three a pixel.
using Values = std::vector<double>;

/// Of at least one value.
double mean(std::span<const double> values);

/// Of at least one value.
double median(std::vector<double> values);

/// Mean of (a - b)^2. The images have the same size and at least one pixel.
double mean_squared_difference(const Values& a, const Values& b);

/// Two images of one expectation, made from independent random numbers: their mean is the reference.
struct Halves {
    Values a, b;
};
Values mean_of(const Halves& halves);
/// Of the reference: what its own noise adds, on average, to the squared error of whatever is held against it.
/// mean((a - b)^2) / 4, since a - b has four times the variance of (a + b) / 2.
double noise_of(const Halves& reference);
/// Mean squared error of an image against the expectation of the reference: free of bias, so it may come out below zero
/// where the image is nearly as good as the reference.
double corrected_mse(const Values& image, const Halves& reference);

/// An estimate and its standard error.
struct Estimate {
    double value = 0;
    double error = 0;
};

/// The mean over pixels of E[d]^2 from at least two independent samples of the image d: the mean of d_i d_j over all
/// pairs i != j, which no noise inflates. It may come out below zero. Standard error: jackknife over the samples.
Estimate mean_squared_expectation(const std::vector<Values>& samples);

/// Mean over pixels of the variance of at least two independent images of one expectation: for each of them its
/// squared distance from the mean of the others, times (n - 1) / n, so that each by itself is free of bias.
std::vector<double> variances(const std::vector<Values>& images);

/// Slope of the least-squares line through (log x, log y); all values above zero, at least two different x.
double log_log_slope(std::span<const double> x, std::span<const double> y);

/// The one-sided 97.5 % quantile of Student's t, `degrees` >= 1.
double student_t(std::size_t degrees);

}  // namespace raypool::accuracy
