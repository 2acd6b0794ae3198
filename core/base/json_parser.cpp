#include "core/base/json_parser.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text.h"

namespace raypool {
namespace {

using nlohmann::json;

/// Whatever the input held, the message stays one line of bearable length.
[[noreturn]] void throw_one_line(std::string message) {
    constexpr std::size_t kLongest = 1000;
    if (message.size() > kLongest) {
        message.resize(kLongest);
        message += "...";
    }
    throw InputError(printable(message));
}

/// Builds the document while it is parsed, since only then are duplicate keys and too deep nesting visible.
class DocumentBuilder final : public nlohmann::json_sax<json> {
  public:
    DocumentBuilder(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    json take_document() { return std::move(document_); }

    bool null() override { return put(nullptr); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(std::int64_t value) override { return put(value); }
    bool number_unsigned(std::uint64_t value) override { return put(value); }
    bool number_float(double value, const std::string&) override { return put(value); }
    bool string(std::string& value) override { return put(std::move(value)); }
    bool binary(json::binary_t&) override { return false; }  // JSON text has none
    bool start_object(std::size_t) override { return open(json::object()); }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(json::array()); }
    bool end_array() override { return close(); }

    bool key(std::string& name) override {
        const auto [member, is_new] = open_.back().container->emplace(name, nullptr);
        open_.back().key = name;
        if (!is_new) throw_refusal(file_, pointer(), "appear once", "it twice");
        member_ = &*member;
        return true;
    }

    bool parse_error(std::size_t position, const std::string& token, const json::exception& error) override {
        constexpr int kNumberOverflow = 406;
        if (error.id == kNumberOverflow) {
            throw_refusal(file_, pointer(), "be a number within double precision", token);
        }
        // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while parsing ..."
        const std::string what = error.what();
        const std::size_t colon = what.find(": ");
        const std::string_view before = text_.substr(0, position == 0 ? 0 : position - 1);
        const auto line = 1 + std::count(before.begin(), before.end(), '\n');
        const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
        const std::string message = colon == std::string::npos ? what : what.substr(colon + 2);
        throw_one_line(fmt::format("{}:{}:{}: {}", file_, line, column, message));
    }

  private:
    struct OpenContainer {
        json* container;
        std::string key;  // of the member being read, when it is an object
    };

    bool put(json&& value) {
        place(std::move(value));
        return true;
    }

    bool open(json&& container) {
        if (open_.size() == kMaxJsonDepth) {
            throw_refusal(file_, pointer(), fmt::format("not nest deeper than {} levels", kMaxJsonDepth), "more");
        }
        open_.push_back({place(std::move(container)), ""});
        return true;
    }

    bool close() {
        open_.pop_back();
        return true;
    }

    /// An array does not grow while an element of it is open, so the returned address holds until close().
    json* place(json&& value) {
        json* slot = &document_;
        if (!open_.empty() && open_.back().container->is_array()) {
            open_.back().container->push_back(nullptr);
            slot = &open_.back().container->back();
        } else if (!open_.empty()) {
            slot = member_;
        }
        *slot = std::move(value);
        return slot;
    }

    /// The place of the value that comes next.
    std::string pointer() const {
        std::string path;
        for (const OpenContainer& level : open_) {
            const bool is_last = &level == &open_.back();
            path += level.container->is_array() ? fmt::format("/{}", level.container->size() - (is_last ? 0 : 1))
                                                : json_pointer_token(level.key);
        }
        return path;
    }

    std::string_view text_;
    const std::string& file_;
    json document_;
    std::vector<OpenContainer> open_;
    json* member_ = nullptr;
};

}  // namespace

json parse_json(std::string_view text, const std::string& file) {
    if (text.find('\0') != std::string_view::npos)  // to the parser the end of the text
        throw_refusal(file, "", "be text", "a byte that is zero");
    DocumentBuilder builder(text, file);
    json::sax_parse(text.begin(), text.end(), &builder);
    return builder.take_document();
}

std::string json_pointer_token(std::string_view key) {
    std::string token = "/";
    for (const char c : key) {
        if (c == '~') {
            token += "~0";
        } else if (c == '/') {
            token += "~1";
        } else {
            token += c;
        }
    }
    return token;
}

void throw_refusal(const std::string& file, const std::string& pointer, const std::string& rule,
                   const std::string& got) {
    throw_one_line(fmt::format("{}: {}{}must {}, got {}", file, pointer, pointer.empty() ? "" : ": ", rule, got));
}

}  // namespace raypool
