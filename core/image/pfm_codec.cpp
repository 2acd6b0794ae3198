/// Portable Float Map: "PF" (colour) or "Pf" (grey), width, height and a scale whose sign tells the byte order, then
/// rows from the bottom up. Words of the header may have any white space and comments (# to the end of the line) before
/// them, as in Netpbm's other formats; after the last comes one white space, or CR LF.
/// Format: Paul Debevec, http://www.pauldebevec.com/Research/HDR/PFM/

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "core/image/image_codecs.h"

namespace raypool {
namespace {

static_assert(std::endian::native == std::endian::little, "PFM files are written as they lie in memory");

constexpr std::string_view kWhiteSpace = " \t\r\n";

/// Takes one word, and what may lie before it, off the front of `text`.
std::string_view take_word(std::string_view& text) {
    constexpr std::size_t kLongestWord = 32;
    const auto drop = [&](std::size_t size) { text.remove_prefix(std::min(size, text.size())); };
    drop(text.find_first_not_of(kWhiteSpace));
    while (text.starts_with('#')) {
        drop(text.find_first_of("\r\n"));
        drop(text.find_first_not_of(kWhiteSpace));
    }
    const std::size_t end = text.substr(0, kLongestWord).find_first_of(kWhiteSpace);
    if (end == 0 || end == std::string_view::npos) throw std::runtime_error("not a PFM file: broken header");
    const std::string_view word = text.substr(0, end);
    drop(end);
    return word;
}

template <class Number>
Number take_number(std::string_view& text) {
    const std::string_view word = take_word(text);
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc{} || end != word.data() + word.size()) {
        throw std::runtime_error("not a PFM file: a header holds width, height and scale as numbers");
    }
    return number;
}

float byte_swapped(float value) {
    return std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
}

}  // namespace

Bytes encode_pfm(const Image& image) {
    const std::string header = fmt::format("PF\n{} {}\n-1.0\n", image.width, image.height);
    const std::size_t row_bytes = static_cast<std::size_t>(image.width) * 3 * sizeof(float);
    Bytes bytes(header.size() + row_bytes * static_cast<std::size_t>(image.height));
    std::memcpy(bytes.data(), header.data(), header.size());
    std::byte* row = bytes.data() + header.size();
    for (std::int64_t y = image.height - 1; y >= 0; --y, row += row_bytes) {
        std::memcpy(row, image.pixel(0, y), row_bytes);
    }
    return bytes;
}

ImageContents decode_pfm(BytesView bytes, const ImageLimits& limits) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!text.starts_with("PF") && !text.starts_with("Pf")) {
        throw std::runtime_error("not a PFM file: must begin with PF or Pf");
    }
    const std::string_view kind = take_word(text);
    if (kind.size() != 2) throw std::runtime_error("must be PF (colour) or Pf (grey), and no other kind of PFM");
    const auto width = take_number<std::int64_t>(text);
    const auto height = take_number<std::int64_t>(text);
    const auto scale = take_number<double>(text);
    check_image_size(width, height, limits.side, limits.pixels);
    if (!std::isfinite(scale) || scale == 0) throw std::runtime_error("the scale must be finite and not 0");

    const std::size_t channels = kind == "PF" ? 3 : 1;
    const std::size_t row_values = static_cast<std::size_t>(width) * channels;
    const std::size_t pixel_bytes = row_values * sizeof(float) * static_cast<std::size_t>(height);
    // Whether a line feed after a carriage return belongs to the pixels, their number tells.
    text.remove_prefix(text.starts_with("\r\n") && text.size() == pixel_bytes + 2 ? 2 : 1);
    if (text.size() != pixel_bytes) {
        throw std::runtime_error(fmt::format("{} x {} pixels must take {} bytes after the header, got {}", width,
                                             height, pixel_bytes, text.size()));
    }
    Image image(width, height);
    std::vector<float> row(row_values);
    for (std::int64_t y = height - 1; y >= 0; --y, text.remove_prefix(row_values * sizeof(float))) {
        std::memcpy(row.data(), text.data(), row_values * sizeof(float));
        float* value = image.pixel(0, y);
        for (std::size_t i = 0; i < row_values * (3 / channels); ++i) {
            const float stored = row[i * channels / 3];
            value[i] = scale > 0 ? byte_swapped(stored) : stored;
        }
    }
    return whole(std::move(image));
}

}  // namespace raypool
