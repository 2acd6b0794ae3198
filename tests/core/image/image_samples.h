/// Images and files that the tests of image files share.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/image/image_file.h"

namespace raypool {

inline const ImageAttributes kAttributes{{"raypool.hash", "0123456789abcdef"}, {"raypool.settings", "{\"spp\": 4}"}};

/// Values of every magnitude and sign, and all that is odd about floats.
inline Image wild_image(std::int64_t width, std::int64_t height) {
    Image image(width, height);
    std::uint32_t bits = 1;
    for (float& value : image.rgb) value = std::bit_cast<float>(bits = bits * 1664525 + 1013904223);
    constexpr std::array<std::uint32_t, 6> kOdd{0x80000000, 0x7f800000, 0xff800000, 0x7fc00001, 0xffa00000, 1};
    for (std::size_t i = 0; i < kOdd.size() && i < image.rgb.size(); ++i) image.rgb[i] = std::bit_cast<float>(kOdd[i]);
    return image;
}

inline bool same_bits(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.rgb.size() == b.rgb.size() &&
           std::memcmp(a.rgb.data(), b.rgb.data(), a.rgb.size() * sizeof(float)) == 0;
}

/// What reading `path` is refused with; empty if it is not. Any other exception fails the test.
inline std::string refusal(const std::filesystem::path& path) {
    try {
        read_image(path);
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_EQ(text.find(path.string() + ": cannot read: "), 0U) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        return text.substr(path.string().size() + std::strlen(": cannot read: "));
    }
    return {};
}

/// A PNG file of any kind; empty rows for one that ends after its header. Errors abort the test.
inline std::string png_of(png_uint_32 width, png_uint_32 height, int bit_depth, int color_type, int interlace,
                          double gamma, std::vector<std::vector<png_byte>> rows) {
    std::string text;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_write_fn(
        png, &text,
        [](png_structp stream, png_bytep data, std::size_t size) {
            static_cast<std::string*>(png_get_io_ptr(stream))->append(reinterpret_cast<char*>(data), size);
        },
        nullptr);
    png_set_IHDR(png, info, width, height, bit_depth, color_type, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    const std::array<png_color, 2> palette{{{255, 0, 0}, {0, 128, 255}}};
    const std::array<png_byte, 2> transparency{0, 128};
    if (color_type == PNG_COLOR_TYPE_PALETTE) {
        png_set_PLTE(png, info, palette.data(), palette.size());
        png_set_tRNS(png, info, transparency.data(), transparency.size(), nullptr);
    }
    if (gamma > 0) png_set_gAMA(png, info, gamma);
    png_write_info(png, info);
    std::vector<png_bytep> pointers;
    pointers.reserve(rows.size());
    for (auto& row : rows) pointers.push_back(row.data());
    if (!rows.empty()) {
        png_write_image(png, pointers.data());
        png_write_end(png, info);
    }
    png_destroy_write_struct(&png, &info);
    return text;
}

}  // namespace raypool
