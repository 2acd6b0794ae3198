/// What tests of scene files share: the smallest scene, how a text is changed, and what a refusal says.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace raypool::scene_text {

inline const std::filesystem::path kScenes = std::filesystem::path(RAYPOOL_SOURCE_DIR) / "scenes";

inline std::string with(const std::string& text, const std::string& part, const std::string& instead) {
    const std::size_t at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return std::string(text).replace(at, part.size(), instead);
}

/// What the InputError of `act` says; empty when there is none.
template <class Act>
std::string refusal(Act act) {
    try {
        act();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

inline const std::string kSmallest = R"({
  "description": "nothing",
  "camera": {"look_from": [0, 0, 1], "look_at": [0, 0, 0]},
  "background": [0.25, 0.5, 1],
  "shapes": []
})";

}  // namespace raypool::scene_text
