/// Where a figure comes from: what goes beside every measurement so that it can be judged and repeated.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace raypool {

/// What the compiler was allowed to use, whatever the flags call it (-march=native), and what the kernels use of it.
struct CodeWidths {
    std::vector<std::string> instruction_sets;  ///< kInstructionSets (core/math/processor.h)
    int float_lanes;                            ///< rays that a stage of the pool treats at a time
    int double_lanes;
    int float_tree_width;  ///< boxes, or primitives, that a ray is tested against at a time
    int double_tree_width;
};
CodeWidths code_widths();

/// {version, commit, compiler, flags, build, simd: {instruction_sets, stage_lanes: {float, double}, tree_width: {float,
/// double}}, cpu, cores, os, openmp: {OMP_*: value}}. `build` is "release" or "debug". All texts are UTF-8.
nlohmann::json environment_json();

}  // namespace raypool
