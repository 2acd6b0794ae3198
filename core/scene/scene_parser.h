/// The text of a scene (docs/scene-format.md) to a Scene. A scene is complete and within all ranges of
/// core/scene/scene.h, or InputError names the file, the JSON pointer in it, the rule and the value found.
///
/// Called by scene_reader.cpp and by tests. Keeps no state.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/scene/scene.h"

namespace raypool {

/// Image textures are looked up below `texture_folder`. The name becomes the scene's, without folder and extension.
Scene parse_scene(std::string_view json_text, const std::string& name_for_messages,
                  const std::filesystem::path& texture_folder);

}  // namespace raypool
