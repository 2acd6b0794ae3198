#include "python/scene_binding.h"

#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "cli/stopwatch.h"
#include "core/scene/scene_parser.h"
#include "core/scene/scene_reader.h"
#include "python/errors.h"

namespace raypool::python {

namespace py = pybind11;

namespace {

/// What `read` returns, with the time that it took; without the GIL. `file` is its name in messages.
template <class Read>
LoadedScene timed(const std::string& file, Read read) {
    const py::gil_scoped_release no_gil;
    const cli::Stopwatch watch;
    try {
        auto scene = std::make_shared<const Scene>(read());
        return {std::move(scene), watch.seconds()};
    } catch (const InputError& error) {
        throw SceneError(error.what(), file);
    }
}

LoadedScene load_named(const std::string& name) {
    return timed(name, [&] { return load_scene(name); });
}

LoadedScene parse_text(const std::string& text, const std::string& name, const std::string& folder) {
    return timed(name, [&] { return parse_scene(text, name, folder); });
}

py::dict counts(const LoadedScene& loaded) {
    const Scene& scene = *loaded.scene;
    std::size_t triangles = 0;
    for (const MeshShape& shape : scene.meshes) triangles += shape.mesh->triangles.size();
    py::dict result;
    result["spheres"] = scene.spheres.size();
    result["quads"] = scene.quads.size();
    result["planes"] = scene.planes.size();
    result["meshes"] = scene.meshes.size();
    result["triangles"] = triangles;
    result["materials"] = scene.materials.size();
    result["textures"] = scene.textures.size();
    return result;
}

std::string representation(const LoadedScene& loaded) {
    const Scene& scene = *loaded.scene;
    return fmt::format("<raypool.Scene {}: {} x {} pixels, {} spheres, {} quads, {} planes, {} meshes>",
                       std::string(py::repr(py::str(scene.name))), scene.width, scene.height, scene.spheres.size(),
                       scene.quads.size(), scene.planes.size(), scene.meshes.size());
}

}  // namespace

void add_scene(py::module_& module) {
    auto scene =
        py::class_<LoadedScene>(module, "Scene",
                                "A scene that raypool.load() has read. It does not change, and threads may share it.")
            .def_property_readonly(
                "name", [](const LoadedScene& loaded) { return loaded.scene->name; },
                "The name of its file without folder and extension, or of the built-in scene.")
            .def_property_readonly(
                "description", [](const LoadedScene& loaded) { return loaded.scene->description; },
                "What the scene is for, in its author's words.")
            .def_property_readonly(
                "width", [](const LoadedScene& loaded) { return loaded.scene->width; },
                "The image's width in pixels where a render is not told another, within [1, 65536].")
            .def_property_readonly(
                "height", [](const LoadedScene& loaded) { return loaded.scene->height; },
                "The image's height in pixels where a render is not told another, within [1, 65536].")
            .def_property_readonly(
                "counts", &counts,
                "How many spheres, quads, planes, meshes, triangles, materials and textures it has. A "
                "triangle counts once for each place of its mesh.")
            .def("__repr__", &representation);
    scene.attr("__module__") = "raypool";  // where users find it

    module.def("load_named", &load_named, py::arg("name"));
    module.def("parse_text", &parse_text, py::arg("text"), py::arg("name"), py::arg("folder"));
    module.def("scenes", &builtin_scene_names, "The names of the built-in scenes, sorted.");
}

}  // namespace raypool::python
