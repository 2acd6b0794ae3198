/// What a case of numerical stability is: one parameter made harder step by step, and what several methods then get
/// wrong.
///
/// The study `stability` draws the curves and times the methods; tests/stability/ asserts the sharp points. Everything
/// here is deterministic: inputs come from fixed seeds, and errors are judged by a wider oracle (128-bit numbers, long
/// double) or a closed form. Ours are the kernels of core/, instantiated; what else there is lies in bench/naive/.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raypool::stability {

enum class Kind : std::uint8_t {
    Naive,        ///< must break within the values of its case
    Alternative,  ///< shown beside the two, nothing asserted
    Ours,         ///< must hold the tolerance at the first `held` values of its case
};

struct Method {
    std::string name;  ///< unique within the case
    Kind kind = Kind::Ours;
    /// The case's measure at one value of its parameter, from `samples` inputs; not-a-number is never returned.
    std::function<double(double value, std::int64_t samples)> error;
    /// Does what the method does `calls` times, for the clock; the result depends on all of it. May be empty.
    std::function<double(std::int64_t calls)> work = {};
};

struct Case {
    std::string id;
    std::string row;  ///< of the catalogue in docs/stability.md; "+" for what was added to it
    std::string parameter;
    std::vector<double> values;  ///< from easy to hard
    std::string measure;         ///< what the error is, with its unit
    double tolerance = 0;        ///< a method whose error is greater has broken
    std::string symptom;         ///< what an image shows where a method breaks
    std::int64_t samples = 0;    ///< inputs for a smooth curve; a tenth is enough to tell
    std::vector<Method> methods;
    std::size_t held = 0;    ///< how many of the values ours must hold; 0: all
    std::string limit = {};  ///< why ours does not hold the rest

    [[nodiscard]] std::size_t held_values() const { return held == 0 ? values.size() : held; }
    /// A method that does not exist is a bug.
    [[nodiscard]] const Method& method(const std::string& name) const;
};

/// All cases, by the rows of the catalogue.
const std::vector<Case>& all_cases();
/// An id that does not exist is a bug.
const Case& find_case(const std::string& id);

// The families, each in the file of its name.
std::vector<Case> sphere_cases();
std::vector<Case> leaving_cases();
std::vector<Case> coincidence_cases();
std::vector<Case> box_cases();
std::vector<Case> motion_cases();
std::vector<Case> scattering_cases();
std::vector<Case> glass_cases();
std::vector<Case> path_cases();
std::vector<Case> sum_cases();
std::vector<Case> random_cases();
std::vector<Case> texture_cases();
std::vector<Case> size_cases();
std::vector<Case> flat_cases();
std::vector<Case> image_cases();

}  // namespace raypool::stability
