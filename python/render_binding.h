/// A render that Python asked for, by the options of the command.
#pragma once

#include <pybind11/pybind11.h>

namespace raypool::python {

/// Adds render() and engines().
void add_render(pybind11::module_& module);

}  // namespace raypool::python
