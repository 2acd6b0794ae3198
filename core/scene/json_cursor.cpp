#include "core/scene/json_cursor.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/json_parser.h"

namespace raypool {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestQuote = 60;  // of a value that a message repeats

std::string quoted(const std::string& text) {
    const std::string whole = json(text).dump(-1, ' ', true);  // ASCII, so that cutting it cannot split a character
    return whole.size() <= kLongestQuote ? whole
                                         : fmt::format("{}...\"", std::string_view(whole).substr(0, kLongestQuote));
}

std::string describe(const json& value) {
    if (value.is_object()) return "an object";
    if (value.is_array()) return fmt::format("an array of {}", value.size());
    if (value.is_string()) return quoted(value.get_ref<const std::string&>());
    return value.dump();
}

std::string joined(const std::vector<std::string>& words) {
    std::string list;
    for (const std::string& word : words) list += fmt::format("{}{}", list.empty() ? "" : ", ", quoted(word));
    return list.empty() ? "none" : list;
}

}  // namespace

JsonCursor::JsonCursor(const json& value, const std::string& file, std::string pointer)
    : value_(&value), file_(&file), pointer_(std::move(pointer)) {}

bool JsonCursor::is_array() const {
    return value_->is_array();
}
bool JsonCursor::is_object() const {
    return value_->is_object();
}
bool JsonCursor::is_string() const {
    return value_->is_string();
}

double JsonCursor::number(double low, double high) const {
    if (!value_->is_number()) refuse("be a number");
    const double value = value_->get<double>();
    if (!(value >= low && value <= high)) refuse(fmt::format("be within [{:g}, {:g}]", low, high));
    return value;
}

std::int64_t JsonCursor::integer(std::int64_t low, std::int64_t high) const {
    const std::string rule = fmt::format("be a whole number within [{}, {}]", low, high);
    if (!value_->is_number()) refuse(rule);
    const double value = value_->get<double>();
    const bool fits = value >= static_cast<double>(low) && value <= static_cast<double>(high);
    if (!fits || value != std::floor(value)) refuse(rule);
    return static_cast<std::int64_t>(value);
}

Vector3d JsonCursor::vector3(double low, double high) const {
    if (!value_->is_array() || value_->size() != 3) refuse("be an array of 3 numbers");
    return {item(0).number(low, high), item(1).number(low, high), item(2).number(low, high)};
}

std::string JsonCursor::text() const {
    if (!value_->is_string() || value_->get_ref<const std::string&>().empty()) refuse("be a string that is not empty");
    return value_->get<std::string>();
}

std::string JsonCursor::one_of(std::initializer_list<const char*> words) const {
    const std::vector<std::string> list(words.begin(), words.end());
    if (value_->is_string() &&
        std::find(list.begin(), list.end(), value_->get_ref<const std::string&>()) != list.end()) {
        return value_->get<std::string>();
    }
    refuse(fmt::format("be one of {}", joined(list)));
}

std::size_t JsonCursor::size() const {
    if (!value_->is_array()) refuse("be an array");
    return value_->size();
}

JsonCursor JsonCursor::item(std::size_t index) const {
    return child((*value_)[index], std::to_string(index));
}

std::vector<std::pair<std::string, JsonCursor>> JsonCursor::members() const {
    if (!value_->is_object()) refuse("be an object");
    std::vector<std::pair<std::string, JsonCursor>> list;
    list.reserve(value_->size());
    for (const auto& [key, member] : value_->items()) list.emplace_back(key, child(member, key));
    return list;
}

void JsonCursor::refuse(const std::string& rule) const {
    refuse(rule, describe(*value_));
}

void JsonCursor::refuse(const std::string& rule, const std::string& got) const {
    throw_refusal(*file_, pointer_, rule, got);
}

JsonCursor JsonCursor::child(const json& value, std::string_view token) const {
    return {value, *file_, pointer_ + json_pointer_token(token)};
}

JsonObject::JsonObject(const JsonCursor& place) : place_(place) {
    if (!place.value_->is_object()) place.refuse("be an object");
}

JsonCursor JsonObject::required(const char* key) {
    if (const std::optional<JsonCursor> member = optional(key)) return *member;
    std::vector<std::string> present;
    for (const auto& [name, value] : place_.value_->items()) present.push_back(name);
    place_.refuse(fmt::format("have the key {}", quoted(key)), "only " + joined(present));
}

std::optional<JsonCursor> JsonObject::optional(const char* key) {
    known_keys_.emplace_back(key);
    const auto member = place_.value_->find(key);
    if (member == place_.value_->end()) return std::nullopt;
    return place_.child(*member, key);
}

void JsonObject::refuse_unknown_keys() const {
    for (const auto& [key, value] : place_.value_->items()) {
        if (std::find(known_keys_.begin(), known_keys_.end(), key) == known_keys_.end()) {
            place_.child(value, key).refuse("be one of the keys " + joined(known_keys_), quoted(key));
        }
    }
}

}  // namespace raypool
