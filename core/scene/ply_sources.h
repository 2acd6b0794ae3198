/// Where the values of a PLY file's elements come from, after its header: text, or binary data in either byte order.
///
/// Both kinds have the same functions, for a template to call: begin() before and end() after each member of an
/// element, number() and whole_number() for a value that is used, skip() for values that are not. What is wrong is
/// refused at its line or its byte.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/scene/mesh_text.h"
#include "core/scene/ply_header.h"

namespace raypool {

/// A member of an element is a line.
class PlyTextSource {
  public:
    PlyTextSource(std::string_view bytes, std::string_view name, const PlyHeader& header)
        : text_(bytes, name, MeshText::Lines::Plain, header.size) {}

    void begin(const PlyElement& element, std::int64_t /*number*/) {
        text_.skip_white_space();
        if (text_.at_end())
            text_.refuse(fmt::format("the file ends before element {} does", quoted_word(element.name)));
    }
    void end() { text_.expect_line_end(); }

    float number(const PlyProperty& property) {
        const PlyTypeTraits& type = traits(property.type);
        if (!type.is_whole) return text_.number(property.name);
        return static_cast<float>(text_.whole_number(property.name, type.least, type.most));
    }
    std::int64_t whole_number(PlyType type, std::string_view what, std::int64_t least, std::int64_t most) {
        return text_.whole_number(what, std::max(least, traits(type).least), std::min(most, traits(type).most));
    }
    void skip(const PlyProperty& property, std::int64_t count) {
        for (std::int64_t i = 0; i < count; ++i) {
            if (text_.word().empty()) text_.refuse(fmt::format("property {} is missing", quoted_word(property.name)));
        }
    }
    void expect_end() {
        text_.skip_white_space();
        if (!text_.at_end()) text_.refuse("nothing may follow the last element");
    }
    [[noreturn]] void refuse(std::string_view reason) const { text_.refuse(reason); }

  private:
    MeshText text_;
};

template <std::endian kOrder>
class PlyBinarySource {
  public:
    PlyBinarySource(std::string_view bytes, std::string_view name, const PlyHeader& header)
        : name_(name), begin_(bytes.data()), at_(begin_ + header.size), end_(begin_ + bytes.size()) {}

    void begin(const PlyElement& element, std::int64_t number) {
        element_ = element.name;
        number_ = number;
    }
    void end() {}

    float number(const PlyProperty& property) {
        const double value = take_value(property.type, property.name);
        if (!(std::abs(value) <= std::numeric_limits<float>::max())) {
            refuse(fmt::format("{} must be a finite number within single precision, got {:g}", property.name, value));
        }
        return static_cast<float>(value);
    }
    std::int64_t whole_number(PlyType type, std::string_view what, std::int64_t least, std::int64_t most) {
        const auto value = static_cast<std::int64_t>(take_value(type, what));
        if (value < least || value > most) {
            refuse(fmt::format("{} must be a whole number within [{}, {}], got {}", what, least, most, value));
        }
        return value;
    }
    void skip(const PlyProperty& property, std::int64_t count) {
        take(count * traits(property.type).size, property.name);
    }

    void expect_end() {
        const auto is_white = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
        if (!std::all_of(at_, end_, is_white)) {
            throw InputError(fmt::format("{}: byte {}: nothing may follow the last element", name_, at_ - begin_));
        }
    }
    [[noreturn]] void refuse(std::string_view reason) const {
        throw InputError(
            fmt::format("{}: byte {}: {} {}: {}", name_, at_ - begin_, quoted_word(element_), number_, reason));
    }

  private:
    const char* take(std::int64_t size, std::string_view what) {
        if (size > end_ - at_) refuse(fmt::format("the file ends within {}", quoted_word(what)));
        return std::exchange(at_, at_ + size);
    }
    template <class Value>
    double take_as(std::string_view what) {
        std::array<char, sizeof(Value)> bytes;
        std::memcpy(bytes.data(), take(sizeof(Value), what), sizeof(Value));
        if constexpr (kOrder != std::endian::native) std::reverse(bytes.begin(), bytes.end());
        return static_cast<double>(std::bit_cast<Value>(bytes));
    }
    /// A double holds every value of every type.
    double take_value(PlyType type, std::string_view what) {
        switch (type) {
            case PlyType::Int8:
                return take_as<std::int8_t>(what);
            case PlyType::Uint8:
                return take_as<std::uint8_t>(what);
            case PlyType::Int16:
                return take_as<std::int16_t>(what);
            case PlyType::Uint16:
                return take_as<std::uint16_t>(what);
            case PlyType::Int32:
                return take_as<std::int32_t>(what);
            case PlyType::Uint32:
                return take_as<std::uint32_t>(what);
            case PlyType::Float32:
                return take_as<float>(what);
            case PlyType::Float64:
                break;
        }
        return take_as<double>(what);
    }

    std::string_view name_, element_;
    const char *begin_, *at_, *end_;
    std::int64_t number_ = 0;
};

}  // namespace raypool
