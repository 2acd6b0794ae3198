/// raypool.Scene: a scene that was read, and does not change.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "core/scene/scene.h"

namespace raypool::python {

/// Threads may share it.
struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    double read_s = 0;  ///< what the reading took
};

/// Adds the class Scene and the functions that read one.
void add_scene(pybind11::module_& module);

}  // namespace raypool::python
