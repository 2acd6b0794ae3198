/// Walks through the text of a mesh file by lines and words: OBJ files, headers of PLY files, ascii PLY files.
///
/// Words are separated by spaces, tabs and carriage returns; a line ends with a line feed or with the text. Every
/// function but skip_white_space() and next_line() stays within the line. Refusals name the line, which is counted only
/// then.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/text.h"

namespace raypool {

/// A word of a file as a message quotes it: printable, and not at length.
inline std::string quoted_word(std::string_view word) {
    constexpr std::size_t kLongest = 40;
    return fmt::format("\"{}{}\"", printable(word.substr(0, kLongest)), word.size() > kLongest ? "..." : "");
}

class MeshText {
  public:
    /// Whether a \ before a line feed makes one line of two.
    enum class Lines { Plain, Continued };

    /// Starts at `begin` bytes into `text`; lines are counted from the first byte of `text`.
    MeshText(std::string_view text, std::string_view name, Lines lines = Lines::Plain, std::size_t begin = 0)
        : text_(text), name_(name), at_(text.data() + begin), end_(text.data() + text.size()), lines_(lines) {}

    [[nodiscard]] bool at_end() const { return at_ == end_; }
    [[nodiscard]] std::size_t offset() const { return static_cast<std::size_t>(at_ - text_.data()); }

    /// Skips blanks, then tells whether the line has no more words.
    bool at_line_end() {
        for (;;) {
            while (at_ != end_ && is_blank(*at_)) ++at_;
            if (at_ == end_ || *at_ != '\\' || lines_ == Lines::Plain) break;
            const std::string_view rest(at_, end_);
            const std::size_t size = rest.starts_with("\\\n") ? 2 : rest.starts_with("\\\r\n") ? 3 : 0;
            if (size == 0) break;
            at_ += size;
        }
        return at_ == end_ || *at_ == '\n';
    }
    void skip_white_space() {
        while (at_line_end() && !at_end()) ++at_;
    }
    void next_line() {
        at_ = std::find(at_, end_, '\n');
        if (at_ != end_) ++at_;
    }
    /// Takes the character if it stands next, without a blank before it.
    bool take(char c) {
        const bool is_next = at_ != end_ && *at_ == c;
        if (is_next) ++at_;
        return is_next;
    }

    [[nodiscard]] bool at_word_end() const { return is_word_end(at_); }

    /// Empty where the line has no more.
    std::string_view word() {
        at_line_end();
        const std::string_view taken = next_word();
        at_ += taken.size();
        return taken;
    }

    /// The float nearest to the word; `what` it is for goes into the refusal.
    float number(std::string_view what) {
        const char* const start = find_number(what);
        float value = 0;
        auto [stop, error] = std::from_chars(start, end_, value);
        if (error == std::errc::result_out_of_range) {  // what rounds to 0 or a denormal is a number all the same
            double wide = 0;
            if (std::from_chars(start, end_, wide).ec == std::errc() && std::abs(wide) < 1) {
                error = std::errc();
                value = static_cast<float>(wide);
            }
        }
        if (error != std::errc() || !std::isfinite(value) || !is_word_end(stop)) {
            refuse_value(what, "a finite number within single precision");
        }
        at_ = stop;
        return value;
    }

    /// Ends where the word does, or at a slash where `may_end_at_slash`.
    std::int64_t whole_number(std::string_view what, std::int64_t least, std::int64_t most,
                              bool may_end_at_slash = false) {
        const char* const start = find_number(what);
        std::int64_t value = 0;
        const auto [stop, error] = std::from_chars(start, end_, value);
        const bool is_whole = is_word_end(stop) || (may_end_at_slash && *stop == '/');
        if (error != std::errc() || !is_whole || value < least || value > most) {
            refuse_value(what, fmt::format("a whole number within [{}, {}]", least, most));
        }
        at_ = stop;
        return value;
    }

    [[noreturn]] void refuse(std::string_view reason) const {
        throw InputError(fmt::format("{}:{}: {}", name_, std::count(text_.data(), at_, '\n') + 1, reason));
    }
    /// Refuses the word that stands next.
    [[noreturn]] void refuse_value(std::string_view what, std::string_view rule) const {
        refuse(fmt::format("{} must be {}, got {}", what, rule, quoted_word(next_word())));
    }
    /// Refuses words that are left in the line.
    void expect_line_end() {
        if (!at_line_end()) refuse(fmt::format("the line must end before {}", quoted_word(next_word())));
    }

  private:
    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
    [[nodiscard]] bool is_word_end(const char* place) const {
        return place == end_ || is_blank(*place) || *place == '\n';
    }
    [[nodiscard]] std::string_view next_word() const {
        const char* stop = at_;
        while (!is_word_end(stop)) ++stop;
        return {at_, stop};
    }
    /// Where std::from_chars is to start: it takes no plus sign.
    const char* find_number(std::string_view what) {
        if (at_line_end()) refuse(fmt::format("{} is missing", what));
        const bool has_plus = *at_ == '+' && end_ - at_ > 1 && at_[1] != '-';
        return at_ + (has_plus ? 1 : 0);
    }

    std::string_view text_, name_;
    const char *at_, *end_;
    Lines lines_;
};

}  // namespace raypool
