#include "cli/engines.h"

#include "recursive/engine.h"
#include "wavefront/engine.h"

namespace raypool::cli {

const EngineRegistry& engines() {
    static const EngineRegistry all = [] {
        EngineRegistry registry;
        wavefront::add_engines(registry);
        recursive::add_engines(registry);
        return registry;
    }();
    return all;
}

}  // namespace raypool::cli
