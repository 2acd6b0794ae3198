#include "core/image/image_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <new>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/base/output_file.h"
#include "core/base/text.h"
#include "core/image/image_codecs.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

/// Runs `work`; turns what a codec throws into one line that names the file.
template <class Work>
auto naming(const fs::path& path, const char* verb, Work work) {
    std::string reason;
    try {
        return work();
    } catch (const InputError&) {
        throw;
    } catch (const std::bad_alloc&) {
        reason = "not enough memory";
    } catch (const std::exception& error) {
        reason = error.what();
    }
    // A library's message may quote bytes of a hostile file.
    const auto is_control = [](unsigned char c) { return std::iscntrl(c) != 0; };
    std::replace_if(reason.begin(), reason.end(), is_control, '?');
    throw InputError(fmt::format("{}: cannot {}: {}", path.string(), verb, reason));
}

constexpr std::uintmax_t kMaxImageBytes = std::uintmax_t{1} << 34;  // of the largest image, uncompressed, and some

Bytes read_bytes(const fs::path& path, std::uintmax_t max_size) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) throw std::runtime_error(error.message());
    if (size > max_size) throw std::runtime_error("larger than any image that can be read");

    errno = 0;
    std::ifstream file(path, std::ios::binary);
    Bytes bytes(file ? size : 0);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file) throw std::runtime_error(std::generic_category().message(errno != 0 ? errno : EIO));
    return bytes;
}

}  // namespace

ImageFormat image_format(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".png") return ImageFormat::Png;
    if (extension == ".exr") return ImageFormat::Exr;
    if (extension == ".pfm") return ImageFormat::Pfm;
    throw InputError(fmt::format("{}: an image file's name must end in .png, .exr or .pfm", path.string()));
}

void write_image(const fs::path& path, const Image& image, const ImageAttributes& attributes) {
    write_image(path, image_format(path), image, attributes);
}

void write_image(const fs::path& path, ImageFormat format, const Image& image, const ImageAttributes& attributes,
                 const ExrExtras& extras) {
    RAYPOOL_CHECK(image.width > 0 && image.height > 0 && std::ssize(image.rgb) == image.width * image.height * 3,
                  "an image has three values for each of its pixels");
    RAYPOOL_CHECK(format == ImageFormat::Exr || extras.is_empty(), "only an EXR file has room for extras");
    for (const ImageChannel& channel : extras.channels)
        RAYPOOL_CHECK(std::ssize(channel.values) == image.width * image.height, "a channel has a value for each pixel");
    ImageAttributes texts;
    for (const auto& [name, text] : attributes) texts.emplace(name, valid_utf8(text));
    const Bytes bytes = naming(path, "write", [&] {
        switch (format) {
            case ImageFormat::Png:
                return encode_png(image, texts);
            case ImageFormat::Exr:
                return encode_exr(image, texts, extras);
            case ImageFormat::Pfm:
                break;
        }
        return encode_pfm(image);
    });
    write_whole(path, bytes);
}

ImageContents read_image_contents(const fs::path& path) {
    const ImageFormat format = image_format(path);
    return naming(path, "read", [&] {
        const Bytes bytes = read_bytes(path, kMaxImageBytes);
        switch (format) {
            case ImageFormat::Png:
                return decode_png(bytes, kMaxImageSide, kMaxImagePixels);
            case ImageFormat::Exr:
                return decode_exr(bytes);
            case ImageFormat::Pfm:
                break;
        }
        return decode_pfm(bytes);
    });
}

Image read_image(const fs::path& path) {
    return read_image_contents(path).image;
}

Image read_texture(const fs::path& path, std::int64_t max_texels) {
    return naming(path, "read", [&] {
        const auto max_size = 9 * static_cast<std::uintmax_t>(max_texels) + (1U << 20U);  // 8 bytes a texel, and some
        return decode_png(read_bytes(path, max_size), kMaxTextureSide, max_texels).image;
    });
}

Image read_environment(const fs::path& path, std::int64_t max_texels) {
    const ImageFormat format = image_format(path);
    return naming(path, "read", [&] {
        const auto max_size =
            64 * static_cast<std::uintmax_t>(max_texels) + (1U << 20U);  // 16 values a texel, and some
        const ImageLimits limits{kMaxTextureSide, max_texels};
        if (format == ImageFormat::Png) throw std::runtime_error("a PNG image, whose values end at 1");
        const Bytes bytes = read_bytes(path, std::min(max_size, kMaxImageBytes));
        return (format == ImageFormat::Exr ? decode_exr(bytes, limits) : decode_pfm(bytes, limits)).image;
    });
}

}  // namespace raypool
