#include "bench/studies/needs_pool.h"

namespace raypool::studies {

RenderFunction pool_render_front(std::size_t set) {
    return render_of_set<FusedPool, 0, kFrontSets>(set);
}

}  // namespace raypool::studies
