#include "bench/studies/needs_pool.h"

namespace raypool::studies {

RenderFunction pool_render_back(std::size_t set) {
    return render_of_set<FusedPool, kFrontSets, kFeatureSets.size() - kFrontSets>(set);
}

}  // namespace raypool::studies
