#include "core/scene/scene_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/scene/builtin_scenes.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;  // also keeps every id within 32 bits

std::string read_text(const fs::path& file) {
    const auto fail = [&](int cause) {
        throw InputError(fmt::format("{}: cannot be read: {}", file.string(), std::generic_category().message(cause)));
    };
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
    if (!stream) fail(errno);

    std::string text;
    std::string block(std::size_t{1} << 16, '\0');
    while (const std::size_t count = std::fread(block.data(), 1, block.size(), stream.get())) {
        text.append(block, 0, count);
        if (text.size() > kMaxFileBytes) {
            throw InputError(fmt::format("{}: must not be longer than {} bytes", file.string(), kMaxFileBytes));
        }
    }
    if (std::ferror(stream.get())) fail(errno);
    return text;
}

const BuiltinSceneText* find_builtin(const std::string& name) {
    const auto texts = builtin_scene_texts();
    const auto found = std::find_if(texts.begin(), texts.end(), [&](const auto& text) { return text.name == name; });
    return found == texts.end() ? nullptr : &*found;
}

}  // namespace

Scene read_scene(const fs::path& file) {
    return parse_scene(read_text(file), file.string(), file.parent_path());
}

std::vector<std::string> builtin_scene_names() {
    std::vector<std::string> names;
    for (const BuiltinSceneText& text : builtin_scene_texts()) names.emplace_back(text.name);
    return names;
}

Scene builtin_scene(const std::string& name) {
    const BuiltinSceneText* builtin = find_builtin(name);
    if (!builtin) {
        throw InputError(fmt::format("{}: no such file, and no built-in scene of that name (there are {})", name,
                                     fmt::join(builtin_scene_names(), ", ")));
    }
    std::string text;
    for (const std::string_view piece : builtin->pieces) text += piece;
    return parse_scene(text, name, {});
}

Scene load_scene(const std::string& file_or_builtin_name) {
    if (file_or_builtin_name == "-") return parse_scene(read_text("/dev/stdin"), "stdin", {});
    std::error_code ignored;  // a name that cannot even be looked up is no file
    const fs::file_status status = fs::status(file_or_builtin_name, ignored);
    const bool is_file = fs::exists(status) && !(fs::is_directory(status) && find_builtin(file_or_builtin_name));
    return is_file ? read_scene(file_or_builtin_name) : builtin_scene(file_or_builtin_name);
}

}  // namespace raypool
