#include "core/base/text.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include <fmt/format.h>

namespace raypool {

namespace {

struct Character {
    std::size_t size;  ///< bytes
    std::uint32_t code;
    bool is_valid;
};

/// The character that `text`, which is not empty, begins with (RFC 3629); a single byte where that is none.
Character first_character(std::string_view text) {
    constexpr Character kInvalid{1, 0, false};
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};  // what needs so many bytes
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
    const int ones = std::countl_one(byte(0));
    if (ones == 0) return {1, byte(0), true};
    const auto size = static_cast<std::size_t>(ones);
    if (ones == 1 || size > 4 || size > text.size()) return kInvalid;
    std::uint32_t code = byte(0) & (0x7FU >> size);
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) return kInvalid;
        code = code << 6U | (byte(i) & 0x3FU);
    }
    const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
    if (code < kLeast[size] || code > 0x10FFFF || is_surrogate) return kInvalid;
    return {size, code, true};
}

/// What a terminal acts on instead of showing it.
bool is_command(std::uint32_t code) {
    const auto is_within = [code](std::uint32_t first, std::uint32_t last) { return code >= first && code <= last; };
    return code < 0x20 || is_within(0x7F, 0x9F) || code == 0x61C || code == 0x200E || code == 0x200F ||
           is_within(0x2028, 0x202E) || is_within(0x2066, 0x2069);
}

/// Calls take(bytes, character) for one character after the other.
template <class Take>
void for_each_character(std::string_view text, Take take) {
    while (!text.empty()) {
        const Character character = first_character(text);
        take(text.substr(0, character.size), character);
        text.remove_prefix(character.size);
    }
}

}  // namespace

std::string valid_utf8(std::string_view text) {
    std::string result;
    for_each_character(text, [&](std::string_view bytes, const Character& character) {
        result += character.is_valid ? bytes : std::string_view("\xEF\xBF\xBD");
    });
    return result;
}

std::string printable(std::string_view text) {
    std::string result;
    for_each_character(text, [&](std::string_view bytes, const Character& character) {
        if (character.is_valid && !is_command(character.code)) {
            result += bytes;
        } else if (bytes.size() == 1) {
            fmt::format_to(std::back_inserter(result), "\\x{:02x}", static_cast<std::uint8_t>(bytes[0]));
        } else {
            fmt::format_to(std::back_inserter(result), "\\u{:04x}", character.code);
        }
    });
    return result;
}

std::string shell_word(std::string_view text) {
    constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-";
    const bool is_printable = printable(text) == text;
    std::string result(is_printable ? "'" : "$'");
    for (const char c : text) {
        if (is_printable) {
            result += c == '\'' ? "'\\''" : std::string(1, c);
        } else if (kPlain.find(c) != std::string_view::npos) {
            result += c;
        } else {
            fmt::format_to(std::back_inserter(result), "\\x{:02x}", static_cast<std::uint8_t>(c));
        }
    }
    const bool is_plain = !text.empty() && text.find_first_not_of(kPlain) == std::string_view::npos;
    return is_plain ? std::string(text) : result + "'";
}

}  // namespace raypool
