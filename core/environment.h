/// Where a figure comes from: what goes beside every measurement so that it can be judged and repeated.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace raypool {

/// {version, commit, compiler, flags, build, cpu, cores, os, openmp: {OMP_*: value}}. `build` is "release" or "debug".
nlohmann::json environment_json();

}  // namespace raypool
