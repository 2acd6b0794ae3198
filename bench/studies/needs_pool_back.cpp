#include "bench/studies/needs_pool.h"

namespace raypool::studies {

BeginFunction pool_begin_back(std::size_t set) {
    return begin_of_set<FusedPool, kFrontSets, kFeatureSets.size() - kFrontSets>(set);
}

}  // namespace raypool::studies
