#include "core/base/json_file.h"

#include <span>

#include <nlohmann/json.hpp>

#include "core/base/output_file.h"

namespace raypool {

std::string json_text(const nlohmann::json& json, JsonLayout layout) {
    constexpr bool kAsciiOnly = false;
    return json.dump(layout == JsonLayout::Indented ? 2 : -1, ' ', kAsciiOnly,
                     nlohmann::json::error_handler_t::replace);
}

void write_json(const std::filesystem::path& path, const nlohmann::json& json) {
    const std::string text = json_text(json) + "\n";
    write_whole(path, std::as_bytes(std::span(text)));
}

}  // namespace raypool
