/// The studies: each is defined in the file of its name.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/study.h"

namespace raypool::studies {

Study adaptive_study();
Study build_study();
Study depth_study();
Study features_study();
Study framebuffer_study();
Study gpu_study();
Study ladder_study();
Study light_study();
Study load_study();
Study pool_study();
Study ranks_study();
Study replay_study();
Study scaling_study();
Study scene_size_study();
Study schedules_study();
Study speed_accuracy_study();
Study stability_study();
Study traversal_study();

/// In the order in which they are listed to users.
std::vector<Study> all_studies();

/// Throws InputError, with the names there are, for a name that is not one.
Study make_study(const std::string& name);

}  // namespace raypool::studies
