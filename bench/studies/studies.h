/// The studies: each is defined in the file of its name, and listed in registry.cpp.
#pragma once

#include <memory>

#include "bench/studies/study.h"

namespace raypool::studies {

std::unique_ptr<Study> adaptive_study();
std::unique_ptr<Study> depth_study();
std::unique_ptr<Study> framebuffer_study();
std::unique_ptr<Study> ladder_study();
std::unique_ptr<Study> features_study();
std::unique_ptr<Study> pool_study();
std::unique_ptr<Study> schedules_study();
std::unique_ptr<Study> load_study();
std::unique_ptr<Study> ranks_study();
std::unique_ptr<Study> replay_study();
std::unique_ptr<Study> scaling_study();
std::unique_ptr<Study> scene_size_study();
std::unique_ptr<Study> speed_accuracy_study();
std::unique_ptr<Study> stability_study();

}  // namespace raypool::studies
