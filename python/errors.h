/// What was refused, as the exception raypool.InputError with the place that the text names.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <pybind11/pybind11.h>

#include "core/base/error.h"

namespace raypool::python {

/// A refusal of a scene whose name in messages is known.
class SceneError : public InputError {
  public:
    SceneError(const std::string& text, std::string file) : InputError(text), file_(std::move(file)) {}
    [[nodiscard]] const std::string& file() const { return file_; }

  private:
    std::string file_;
};

/// The place that a refusal names: the JSON pointer, or line:column, behind the name of the file; the option that it
/// begins with; empty where there is none.
std::string place_of(std::string_view text, const std::string& file);

/// Makes InputError, in whatever function of the module, the exception raypool.InputError. With the GIL.
void translate_errors();

}  // namespace raypool::python
