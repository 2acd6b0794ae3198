#include "bench/studies/features_pool.h"

namespace raypool::studies {

BeginFunction pool_begin_front(std::size_t set) {
    return begin_of_set<FusedPool, 0, kFileSets>(set);
}

}  // namespace raypool::studies
