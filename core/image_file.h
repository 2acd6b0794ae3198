/// Image files: PNG, OpenEXR and PFM, written whole or not at all, read without trusting them.
///
/// PNG: 8 bits a channel, coded with the curve of sRGB, clamped to [0, 1], NaN as black. Lossy.
/// EXR: 32-bit floats, ZIP-compressed; read as OpenEXR reads it, whatever program wrote it (docs/image-files.md).
/// PFM: 32-bit floats, bottom row first; written little endian in colour, read in both byte orders and in grey. Carries
/// no attributes.
/// EXR and PFM keep every bit. The bytes of a file depend on the image and the attributes only.
///
/// Called by the command and by the scene reader. A file that is absent, broken, or larger than the limits throws an
/// InputError naming it, before memory is spent on what it only claims to hold. Thread-safe, for different outputs.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/scene.h"

namespace raypool {

inline constexpr std::int64_t kMaxImageSide = 65536;
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 30;
inline constexpr std::int64_t kMaxTextureSide = 16384;
inline constexpr std::int64_t kMaxSceneTexels = std::int64_t{1} << 28;  ///< of all textures of a scene

enum class ImageFormat { Png, Exr, Pfm };

/// What an image carries besides pixels, such as its settings and its hash. Names are ASCII with 1 to 79 characters.
using ImageAttributes = std::map<std::string, std::string>;

/// A rectangle of pixels; (min_x, min_y) is its top left corner.
struct ImageWindow {
    std::int64_t min_x = 0;
    std::int64_t min_y = 0;
    std::int64_t width = 0;
    std::int64_t height = 0;

    bool operator==(const ImageWindow&) const = default;
};

/// CIE x and y of red, green, blue and white, in this order.
using Chromaticities = std::array<float, 8>;

/// A file's pixels, and what it holds besides them.
struct ImageContents {
    Image image;              ///< the pixels of data_window
    ImageWindow data_window;  ///< differs from display_window in EXR files only
    ImageWindow display_window;
    std::vector<std::string> unread_channels;      ///< in the file, not in `image`: "A", "Z"; of another part "part:Z"
    std::optional<Chromaticities> chromaticities;  ///< where they are not those of sRGB
    ImageAttributes attributes;                    ///< those of type string of an EXR file
};

/// By the extension, in either case; an InputError for any other than .png, .exr and .pfm.
ImageFormat image_format(const std::filesystem::path& path);

void write_image(const std::filesystem::path& path, const Image& image, const ImageAttributes& attributes);

/// PNG samples of 8 or fewer bits, or 16, become linear by the curve of sRGB, or by the exponent in a gAMA chunk that
/// says otherwise; alpha and colour profiles are ignored. Of an EXR file this is the data window.
Image read_image(const std::filesystem::path& path);

/// The same with what read_image() leaves out.
ImageContents read_image_contents(const std::filesystem::path& path);

/// All attributes of type string in the header of an EXR file.
ImageAttributes read_exr_attributes(const std::filesystem::path& path);

/// A PNG file, as read_image() reads it, of at most kMaxTextureSide on either side and at most `max_texels`.
std::shared_ptr<const ImageTexels> read_texture(const std::filesystem::path& path,
                                                std::int64_t max_texels = kMaxSceneTexels);

}  // namespace raypool
