/// Scenes by name: files (docs/scene-format.md) and the built-in ones.
///
/// Called by the command and by tests. The functions keep no state and may run in several threads. They throw
/// InputError as scene_parser.h says, and for a file that cannot be read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "core/scene/scene_parser.h"

namespace raypool {

/// What a user names: "-" for the standard input, whose files are those of the working folder; a file if there is one
/// of that name, else a built-in scene.
Scene load_scene(const std::string& file_or_builtin_name);

Scene read_scene(const std::filesystem::path& file);

/// The scenes/*.json of the source tree, which the library carries (they need no other files).
Scene builtin_scene(const std::string& name);
std::vector<std::string> builtin_scene_names();  ///< sorted

}  // namespace raypool
