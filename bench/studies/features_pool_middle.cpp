#include "bench/studies/features_pool.h"

namespace raypool::studies {

BeginFunction pool_begin_middle(std::size_t set) {
    return begin_of_set<FusedPool, kFileSets, kFileSets>(set);
}

}  // namespace raypool::studies
