#include "bench/studies/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"

namespace raypool::studies {

std::vector<Study> all_studies() {
    return {
        load_study(),      replay_study(),         schedules_study(),  scaling_study(),
        ranks_study(),     pool_study(),           scene_size_study(), traversal_study(),
        build_study(),     framebuffer_study(),    ladder_study(),     gpu_study(),
#ifndef RAYPOOL_ONE_FEATURE_SET
        features_study(),
#endif
        depth_study(),     speed_accuracy_study(), light_study(),      adaptive_study(),
        stability_study(),
    };
}

Study make_study(const std::string& name) {
    std::vector<std::string> names;
    for (const Study& study : all_studies()) {
        if (study.name == name) return study;
        names.push_back(study.name);
    }
    throw InputError(fmt::format("study: there is no {}; there are {}", name, fmt::join(names, ", ")));
}

}  // namespace raypool::studies
