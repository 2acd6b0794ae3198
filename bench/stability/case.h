/// What a case of numerical stability is: one parameter made harder step by step, and what several methods then get
/// wrong.
///
/// What a case is in words and numbers stands in cases.json; its methods are C++, in the file of its family.
///
/// The study `stability` draws the curves and times the methods; tests/stability/ asserts the sharp points. Everything
/// here is deterministic: inputs come from fixed seeds, and errors are judged by a wider oracle (128-bit numbers, long
/// double) or a closed form. Ours are the kernels of core/, instantiated; what several families or the failed images
/// need beside them lies in bench/naive/.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
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

/// One entry of cases.json, with its methods.
struct Case {
    std::string id;
    std::string row;             ///< of the catalogue in docs/stability.md; "+" for what was added to it
    std::string parameter;       ///< what is made harder
    std::vector<double> values;  ///< from easy to hard
    std::string measure;         ///< what the error is, with its unit
    double tolerance = 0;        ///< a method whose error is greater has broken
    std::int64_t samples = 0;    ///< inputs for a smooth curve; a tenth is enough to tell. 0: the values say all
    std::string symptom;         ///< what an image shows where a method breaks
    std::size_t held = 0;        ///< how many of the values ours must hold: all, unless the entry says "held"
    std::string limit;           ///< why ours does not hold the rest
    std::vector<Method> methods;

    /// A method that does not exist is a bug.
    [[nodiscard]] const Method& method(const std::string& name) const;
};

/// All cases, in the order of cases.json.
const std::vector<Case>& all_cases();
/// An id that does not exist is a bug.
const Case& find_case(const std::string& id);

/// The methods of cases, by the ids of the cases.
using CaseMethods = std::vector<std::pair<std::string, std::vector<Method>>>;

// The families, each in the file of its name; images in failures.cpp.
CaseMethods sphere_cases();
CaseMethods leaving_cases();
CaseMethods coincidence_cases();
CaseMethods box_cases();
CaseMethods motion_cases();
CaseMethods scattering_cases();
CaseMethods glass_cases();
CaseMethods path_cases();
CaseMethods sum_cases();
CaseMethods random_cases();
CaseMethods texture_cases();
CaseMethods size_cases();
CaseMethods planar_cases();
CaseMethods light_cases();
CaseMethods environment_cases();
CaseMethods environment_direction_cases();
CaseMethods mesh_cases();
CaseMethods image_cases();

}  // namespace raypool::stability
