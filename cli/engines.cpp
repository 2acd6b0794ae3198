#include "cli/engines.h"

#include "gpu/engine.h"
#include "recursive/engine.h"
#include "wavefront/engine.h"

#ifdef RAYPOOL_HAS_CUDA
#include "gpu/cuda_device.h"
#endif

namespace raypool::cli {

const EngineRegistry& engines() {
    static const EngineRegistry all = [] {
        EngineRegistry registry;
        wavefront::add_engines(registry);
        recursive::add_engines(registry);
#ifdef RAYPOOL_HAS_CUDA
        gpu::add_engines(
            registry, [](int) { return gpu::cuda_device(); }, gpu::has_cuda_device);
#endif
        return registry;
    }();
    return all;
}

}  // namespace raypool::cli
