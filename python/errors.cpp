#include "python/errors.h"

#include <exception>

#include "core/base/text.h"

namespace raypool::python {

namespace py = pybind11;

namespace {

void set_error(const char* text, const std::string& file) {
    // A text may repeat bytes of a file's name that are not UTF-8.
    const std::string message = valid_utf8(text);
    const std::string place = valid_utf8(place_of(text, file));
    const py::object type = py::module_::import("raypool._errors").attr("InputError");
    const py::object error = type(message, place.empty() ? py::object(py::none()) : py::object(py::str(place)));
    PyErr_SetObject(type.ptr(), error.ptr());
}

}  // namespace

std::string place_of(std::string_view text, const std::string& file) {
    if (text.starts_with("--")) return std::string(text.substr(0, text.find_first_of(": ")));
    const std::string name = printable(file) + ":";
    if (file.empty() || !text.starts_with(name)) return "";
    text.remove_prefix(name.size());
    if (text.starts_with(" /")) return std::string(text.substr(1, text.find(": must ") - 1));
    const std::size_t end = text.find_first_not_of("0123456789:");
    return end == 0 || end == std::string_view::npos ? "" : std::string(text.substr(0, end - 1));
}

void translate_errors() {
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const SceneError& error) {
            set_error(error.what(), error.file());
        } catch (const InputError& error) {
            set_error(error.what(), "");
        }
    });
}

}  // namespace raypool::python
