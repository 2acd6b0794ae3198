/// How cases are put together: ways of computing something, and measures that judge a way.
///
/// A way is a function object. A measure is one too: measure.operator()<Scalar>(way, value, samples) is the error that
/// the way makes, in numbers of that type, at a value of the case's parameter.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/stability/case.h"
#include "tests/errors.h"
#include "tests/random_inputs.h"

namespace raypool::stability {

using test::Errors;
using test::RandomInputs;

/// The methods of a case whose ways are all judged by one measure.
template <class Measure>
class Methods {
  public:
    using Work = std::function<double(std::int64_t calls)>;

    explicit Methods(Measure measure) : measure_(measure) {}

    template <class Scalar = float, class Way>
    Methods& naive(const std::string& name, Way way, Work work = {}) {
        return add<Scalar>(name, Kind::Naive, way, std::move(work));
    }
    template <class Scalar = float, class Way>
    Methods& other(const std::string& name, Way way, Work work = {}) {
        return add<Scalar>(name, Kind::Alternative, way, std::move(work));
    }
    template <class Scalar = float, class Way>
    Methods& ours(const std::string& name, Way way, Work work = {}) {
        return add<Scalar>(name, Kind::Ours, way, std::move(work));
    }
    /// Ours in both precisions; the work is that in single precision.
    template <class Way>
    Methods& ours_in_both(Way way, Work work = {}) {
        return ours<float>("ours, float", way, std::move(work)).template ours<double>("ours, double", way);
    }
    operator std::vector<Method>() const { return methods_; }

  private:
    template <class Scalar, class Way>
    Methods& add(const std::string& name, Kind kind, Way way, Work work) {
        const auto error = [measure = measure_, way](double value, std::int64_t samples) -> double {
            return measure.template operator()<Scalar>(way, value, samples);
        };
        methods_.push_back({name, kind, error, std::move(work)});
        return *this;
    }

    Measure measure_;
    std::vector<Method> methods_;
};

/// A part of `count` that is `of`; 0 where there is nothing to have a part of.
inline double share(std::int64_t of, std::int64_t count) {
    return count == 0 ? 0 : static_cast<double>(of) / static_cast<double>(count);
}

/// The share of inputs for which `is_wrong(random)` is true, of `count` that are drawn. It may return an empty
/// optional: that input does not count.
template <class Test>
double share_of(std::int64_t count, RandomInputs random, Test is_wrong) {
    std::int64_t judged = 0;
    std::int64_t wrong = 0;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::optional<bool> answer = is_wrong(random);
        judged += answer.has_value() ? 1 : 0;
        wrong += answer.value_or(false) ? 1 : 0;
    }
    return share(wrong, judged);
}

/// The errors that `judge(random, errors)` adds for `count` inputs.
template <class Judge>
Errors errors_of(std::int64_t count, RandomInputs random, Judge judge) {
    Errors errors;
    for (std::int64_t i = 0; i < count; ++i) judge(random, errors);
    return errors;
}
/// The error that a part `p` of all does not exceed, at most 1; 1 where nothing was judged.
inline double quantile_up_to_one(const Errors& errors, double p) {
    return errors.count() == 0 ? 1 : std::min(errors.quantile(p), 1.0);
}

/// Work for the clock: the sum of what `function` makes of 256 inputs, which draw(random) made, again and again.
template <class Draw, class Function>
auto sum_over(RandomInputs random, Draw draw, Function function) {
    return [=](std::int64_t calls) {
        RandomInputs drawn = random;
        std::vector<decltype(draw(drawn))> inputs;
        for (int i = 0; i < 256; ++i) inputs.push_back(draw(drawn));
        double sum = 0;
        for (std::int64_t i = 0; i < calls; ++i)
            sum += static_cast<double>(function(inputs[static_cast<std::size_t>(i) % inputs.size()]));
        return sum;
    };
}

}  // namespace raypool::stability
