/// The one way from JSON to text and to a file.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace raypool {

/// The JSON as UTF-8, indented by two, or on one line. Never throws for what its strings hold: bytes that are not UTF-8
/// become U+FFFD.
enum class JsonLayout { Indented, OneLine };
std::string json_text(const nlohmann::json& json, JsonLayout layout = JsonLayout::Indented);

/// Writes the indented text and the end of a line, whole or not at all.
void write_json(const std::filesystem::path& path, const nlohmann::json& json);

}  // namespace raypool
