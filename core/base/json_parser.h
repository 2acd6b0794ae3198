/// JSON text to a document, strictly: what RFC 8259 forbids is refused, and so are keys that appear twice, numbers
/// beyond double precision and deep nesting. Every refusal is an InputError of one line.
///
/// Called by scene_parser.cpp, json_cursor.cpp and checkpoint.cpp.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace raypool {

inline constexpr std::size_t kMaxJsonDepth = 32;  ///< arrays and objects within each other

/// `file` is what messages call the text: `file:line:column: ...` where it is not JSON, else `file: /pointer: must
/// ...`.
nlohmann::json parse_json(std::string_view text, const std::string& file);

/// The part of a JSON pointer (RFC 6901) that leads to the member `key`.
std::string json_pointer_token(std::string_view key);

/// Throws "file: pointer: must <rule>, got <got>", made to fit one printable line.
[[noreturn]] void throw_refusal(const std::string& file, const std::string& pointer, const std::string& rule,
                                const std::string& got);

}  // namespace raypool
