#include "recursive/engine.h"

namespace raypool::recursive {

void add_engines(EngineRegistry& registry) {
    registry.add({.name = "recursive",
                  .description = "the paper's tracer: a bounce is a call",
                  .keeps_costs = true,
                  .has_pool = false,
                  .make = [](const std::any&) { return std::make_unique<RecursiveEngine>(); }});
    registry.add({.name = "iterative",
                  .description = "a loop in place of the call",
                  .keeps_costs = true,
                  .has_pool = false,
                  .make = [](const std::any&) { return std::make_unique<IterativeEngine>(); }});
}

}  // namespace raypool::recursive
