#include "bench/studies/features_pool.h"

namespace raypool::studies {

BeginFunction pool_begin_back(std::size_t set) {
    return begin_of_set<FusedPool, 2 * kFileSets, kFeatureSets.size() - 2 * kFileSets>(set);
}

}  // namespace raypool::studies
