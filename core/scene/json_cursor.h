/// Typed reading of a JSON document. Every refusal is an InputError of one line that names the file, the value's JSON
/// pointer (RFC 6901), the rule and what was found: `a.json: /materials/red/fuzz: must be within [0, 1], got 1.7`.
///
/// Called by scene_parser.cpp alone. A cursor refers to the document and to the file's name: both outlive it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/scene/scene.h"

namespace raypool {

/// One value of a document and the way to it. Each reading function refuses what does not fit.
class JsonCursor {
  public:
    JsonCursor(const nlohmann::json& value, const std::string& file, std::string pointer = "");

    bool is_array() const;
    bool is_object() const;
    bool is_string() const;

    double number(double low, double high) const;  ///< within [low, high]
    std::int64_t integer(std::int64_t low, std::int64_t high) const;
    Vector3d vector3(double low, double high) const;  ///< an array of three numbers, each within [low, high]
    std::string text() const;                         ///< not empty
    std::string one_of(std::initializer_list<const char*> words) const;

    std::size_t size() const;  ///< of an array
    JsonCursor item(std::size_t index) const;
    std::vector<std::pair<std::string, JsonCursor>> members() const;  ///< of an object, sorted by key

    /// `rule` completes the sentence "file: pointer: must ..., got <this value>".
    [[noreturn]] void refuse(const std::string& rule) const;
    /// The same with the reader's own words for what it found.
    [[noreturn]] void refuse(const std::string& rule, const std::string& got) const;

  private:
    friend class JsonObject;
    JsonCursor child(const nlohmann::json& value, std::string_view token) const;

    const nlohmann::json* value_;
    const std::string* file_;
    std::string pointer_;
};

/// The members of an object, asked for by key; it remembers the keys asked for, and these are the keys it knows.
class JsonObject {
  public:
    explicit JsonObject(const JsonCursor& place);

    JsonCursor required(const char* key);
    std::optional<JsonCursor> optional(const char* key);
    void refuse_unknown_keys() const;  ///< call it once all keys have been asked for

    const JsonCursor& place() const { return place_; }

  private:
    JsonCursor place_;
    std::vector<std::string> known_keys_;
};

}  // namespace raypool
