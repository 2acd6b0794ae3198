/// Files of a test: its folder, and reading, writing and counting what is there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "core/base/scratch_folder.h"

namespace raypool {

/// How many files and folders lie in it.
inline std::ptrdiff_t entry_count(const ScratchFolder& folder) {
    return std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator());
}

inline std::string file_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void set_file_text(const std::filesystem::path& path, std::string_view text) {
    std::filesystem::remove(path);  // ext4 waits for the disk when a file is truncated and written again
    std::ofstream file(path, std::ios::binary);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace raypool
