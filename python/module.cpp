// raypool._core: what of the Python module is compiled. The package in raypool/ is what users see, and says what its
// functions promise.
#include <pybind11/pybind11.h>

#include "python/errors.h"
#include "python/render_binding.h"
#include "python/scene_binding.h"

PYBIND11_MODULE(_core, module) {
    module.doc() = "The compiled part of raypool.";
    module.attr("__version__") = RAYPOOL_VERSION;
    raypool::python::translate_errors();
    raypool::python::add_scene(module);
    raypool::python::add_render(module);
}
