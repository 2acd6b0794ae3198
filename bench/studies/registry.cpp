#include "bench/studies/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/studies/studies.h"
#include "core/base/error.h"

namespace raypool::studies {

std::vector<std::unique_ptr<Study>> all_studies() {
    std::vector<std::unique_ptr<Study>> studies;
    studies.push_back(load_study());
    studies.push_back(replay_study());
    studies.push_back(schedules_study());
    studies.push_back(scaling_study());
    studies.push_back(ranks_study());
    studies.push_back(pool_study());
    studies.push_back(scene_size_study());
    studies.push_back(framebuffer_study());
    studies.push_back(ladder_study());
    studies.push_back(features_study());
    studies.push_back(depth_study());
    studies.push_back(speed_accuracy_study());
    studies.push_back(adaptive_study());
    studies.push_back(stability_study());
    return studies;
}

std::unique_ptr<Study> make_study(const std::string& name) {
    std::vector<std::string> names;
    for (std::unique_ptr<Study>& study : all_studies()) {
        // cppcheck-suppress returnStdMoveLocal ; a reference, which cannot be elided
        if (study->name() == name) return std::move(study);
        names.push_back(study->name());
    }
    throw InputError(fmt::format("study: there is no {}; there are {}", name, fmt::join(names, ", ")));
}

}  // namespace raypool::studies
