/// All studies, by name. A new one is listed in registry.cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/studies/study.h"

namespace raypool::studies {

std::vector<std::unique_ptr<Study>> all_studies();

/// Throws InputError, with the names there are, for a name that is not one.
std::unique_ptr<Study> make_study(const std::string& name);

}  // namespace raypool::studies
