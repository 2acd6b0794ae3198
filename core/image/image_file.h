/// Image files: PNG, OpenEXR and PFM, written whole or not at all, read without trusting them.
///
/// PNG: 8 bits a channel, coded with the curve of sRGB, clamped to [0, 1], NaN as black. Lossy.
/// EXR: written as 32-bit floats, or the picture in halves, with other channels beside it (ExrExtras), ZIP-compressed.
/// Read by OpenEXR: scan lines or tiles, one part or several, half, float or integer values, any compression. Of
/// several layers the first that has red, green and blue is taken, of files without one the first luminance. Not read:
/// parts of deep data, channels of fewer values than pixels (but luminance with chroma, which OpenEXR turns into RGB at
/// half precision), and rows so wide and of so many channels that a block of them takes more than 1 GiB and more than 1
/// KiB a byte of the file (kMaxExrBlockValues, kMaxExrExpansion); docs/image-files.md has it all. PFM: 32-bit floats,
/// bottom row first, in colour or grey; written little endian, read in both byte orders. Carries no attributes. EXR and
/// PFM keep every bit. The bytes of a file depend on the image, the attributes and ExrExtras only.
///
/// Called by the command and by the scene reader. A file that is absent, broken, or larger than the limits throws an
/// InputError naming it, before memory is spent on what it only claims to hold. Thread-safe, for different outputs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"

namespace raypool {

inline constexpr std::int64_t kMaxImageSide = 65536;
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 30;
inline constexpr std::int64_t kMaxExrBlockValues = std::int64_t{1} << 28;
inline constexpr std::int64_t kMaxExrExpansion = 256;  ///< or so many values in a block for each byte of the file
inline constexpr std::int64_t kMaxTextureSide = 16384;
inline constexpr std::int64_t kMaxSceneTexels = std::int64_t{1} << 28;  ///< of all images of a scene

/// What an image may claim to be.
struct ImageLimits {
    std::int64_t side = kMaxImageSide;
    std::int64_t pixels = kMaxImagePixels;
};

enum class ImageFormat { Png, Exr, Pfm };

/// What an image carries besides pixels, such as its settings and its hash. Names are ASCII with 1 to 79 characters,
/// texts are written as UTF-8 (core/base/text.h).
using ImageAttributes = std::map<std::string, std::string>;

/// By the extension, in either case; an InputError for any other than .png, .exr and .pfm.
ImageFormat image_format(const std::filesystem::path& path);

/// What is at least this becomes infinite in half precision.
inline constexpr float kInfiniteAsHalf = 65520;

/// A channel of an EXR file beside red, green and blue.
struct ImageChannel {
    std::string name;           ///< "A", or with its layer before it: "albedo.R"
    std::vector<float> values;  ///< one a pixel, row 0 at the top
    bool may_be_half = false;   ///< of a range that half precision keeps well
};

/// What only an EXR file has room for.
struct ExrExtras {
    std::span<const ImageChannel> channels = {};
    /// Red, green and blue, and the channels that may be, in half precision: to 11 significant bits.
    bool is_half = false;
    [[nodiscard]] bool is_empty() const { return channels.empty() && !is_half; }
};

void write_image(const std::filesystem::path& path, const Image& image, const ImageAttributes& attributes);
/// In a format that the name need not say. Extras are for EXR files only.
void write_image(const std::filesystem::path& path, ImageFormat format, const Image& image,
                 const ImageAttributes& attributes, const ExrExtras& extras = {});

/// What a file holds.
struct ImageContents {
    Image image;                        ///< the data window
    PixelWindow data_window;            ///< where the image's pixels lie; the image's own where there is no such thing
    PixelWindow display_window;         ///< what is to be shown of them; likewise
    std::vector<std::string> left_out;  ///< what is in the file and not in `image`, such as "channel A"
    std::string primaries = "sRGB";     ///< chromaticities of red, green, blue and white, where they are others
    ImageAttributes attributes;         ///< of type string, of an EXR file; not the name and type of its part
};

ImageContents read_image_contents(const std::filesystem::path& path);

/// The pixels alone. PNG samples of 8 or fewer bits, or 16, become linear by the curve of sRGB, or by the exponent in a
/// gAMA chunk that says otherwise; alpha and colour profiles are ignored. Of an EXR file this is the data window.
Image read_image(const std::filesystem::path& path);

/// A PNG file, as read_image() reads it, of at most kMaxTextureSide on either side and at most `max_texels`.
Image read_texture(const std::filesystem::path& path, std::int64_t max_texels = kMaxSceneTexels);

/// An EXR or PFM file, as read_image() reads it, within the same limits.
Image read_environment(const std::filesystem::path& path, std::int64_t max_texels = kMaxSceneTexels);

}  // namespace raypool
