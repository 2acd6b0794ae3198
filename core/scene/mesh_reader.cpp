#include "core/scene/mesh_reader.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/memory.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

using MeshReader = Mesh (*)(std::string_view bytes, std::string_view name);

MeshReader reader_for(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".ply") return read_ply;
    if (extension == ".obj") return read_obj;
    throw InputError(fmt::format("{}: a mesh file's name must end in .ply or .obj", path.string()));
}

/// The bytes of a file, which need not be set before they are read.
struct FileBytes {
    std::unique_ptr<char[]> bytes;
    std::size_t size = 0;
};

FileBytes read_file(const fs::path& path) {
    const auto fail = [&](std::string_view reason) {
        throw InputError(fmt::format("{}: cannot be read: {}", path.string(), reason));
    };
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) fail(error.message());
    check_available(2 * size, fmt::format("{}: the file and its mesh", path.string()));

    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!stream) fail(std::generic_category().message(errno));
    FileBytes file{std::make_unique_for_overwrite<char[]>(size), size};
    errno = 0;
    if (std::fread(file.bytes.get(), 1, size, stream.get()) != size) {
        fail(errno != 0 ? std::generic_category().message(errno) : "it became shorter");
    }
    return file;
}

}  // namespace

Mesh read_mesh(const fs::path& path) {
    const MeshReader read = reader_for(path);
    try {
        const FileBytes file = read_file(path);
        const std::string_view bytes(file.bytes.get(), file.size);
        return read(bytes, path.string());
    } catch (const std::bad_alloc&) {
        throw InputError(fmt::format("{}: not enough memory for the file and its mesh", path.string()));
    }
}

}  // namespace raypool
