/// PNG through libpng, whose errors are long jumps.
///
/// A jump lands in one of the small functions marked "jumps". They and the callbacks below them hold nothing that
/// needs a destructor; everything that does lives in their callers, which turn `false` into an exception.

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "core/image/image_codecs.h"
#include "core/image/srgb.h"

namespace raypool {
namespace {

struct PngError {
    char text[128] = "not enough memory";
};

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
    std::snprintf(static_cast<PngError*>(png_get_error_ptr(png))->text, sizeof(PngError::text), "%s", text);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

// --- Reading -------------------------------------------------------------------------------------------------------

/// Checks that the chunks lie within the file, since libpng reserves what a chunk claims to hold before it reads it.
void check_chunks(BytesView bytes) {
    constexpr std::size_t kSignatureSize = 8;
    constexpr std::size_t kChunkFrame = 12;  // length, name and checksum
    const auto* place = reinterpret_cast<png_const_bytep>(bytes.data());
    std::size_t size = bytes.size();
    if (size < kSignatureSize || png_sig_cmp(place, 0, kSignatureSize) != 0) throw std::runtime_error("not a PNG file");

    bool is_end = false;
    for (std::size_t chunk_size = kSignatureSize; !is_end; is_end = std::memcmp(place + 4, "IEND", 4) == 0) {
        place += chunk_size;
        size -= chunk_size;
        if (size < kChunkFrame) throw std::runtime_error("the file ends too early");
        chunk_size = kChunkFrame + png_get_uint_32(place);
        if (size < chunk_size) throw std::runtime_error("the file ends too early");
    }
}

struct PngReader {
    explicit PngReader(BytesView bytes) : rest(bytes) {
        png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &error, on_error, on_warning);
        info = png != nullptr ? png_create_info_struct(png) : nullptr;
    }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

    BytesView rest;  ///< what has not been read
    PngError error;
    png_structp png = nullptr;
    png_infop info = nullptr;
};

void read_bytes(png_structp png, png_bytep target, std::size_t size) {
    auto& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (size > reader.rest.size()) png_error(png, "the file ends too early");
    std::memcpy(target, reader.rest.data(), size);
    reader.rest = reader.rest.subspan(size);
}

/// Jumps. Everything before the pixels.
bool read_header(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
    png_set_read_fn(reader.png, &reader, read_bytes);
    png_read_info(reader.png, reader.info);
    return true;
}

/// Jumps. Asks for every kind of pixel as RGB with 8 or 16 bits a channel.
bool convert_to_rgb(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
    png_set_expand(reader.png);
    png_set_gray_to_rgb(reader.png);
    png_set_strip_alpha(reader.png);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    return true;
}

/// Jumps.
bool read_rows(PngReader& reader, png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

/// The chromaticities of a cHRM chunk, where they are not those of sRGB.
std::string primaries_of(const PngReader& reader) {
    constexpr std::array<double, 8> kSrgb{0.3127, 0.329, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06};  // white first
    std::array<double, 8> xy = kSrgb;
    png_get_cHRM(reader.png, reader.info, xy.data(), &xy[1], &xy[2], &xy[3], &xy[4], &xy[5], &xy[6], &xy[7]);
    const bool is_srgb = std::equal(xy.begin(), xy.end(), kSrgb.begin(), [](double a, double b) {
        return std::abs(a - b) < 1e-3;  // files give three digits
    });
    if (is_srgb) return "sRGB";
    return fmt::format("red {:g} {:g}, green {:g} {:g}, blue {:g} {:g}, white {:g} {:g}", xy[2], xy[3], xy[4], xy[5],
                       xy[6], xy[7], xy[0], xy[1]);
}

/// Linear light for every code of `bit_depth` bits.
std::vector<float> decoding_table(const PngReader& reader, int bit_depth) {
    constexpr double kSrgbGamma = 1 / 2.2;  // what a gAMA chunk says beside sRGB data
    double gamma = kSrgbGamma;
    png_get_gAMA(reader.png, reader.info, &gamma);
    const bool is_srgb = !(gamma > 0) || std::abs(gamma / kSrgbGamma - 1) < 0.05;

    std::vector<float> table(std::size_t{1} << bit_depth);
    for (std::size_t code = 0; code < table.size(); ++code) {
        const double coded = static_cast<double>(code) / static_cast<double>(table.size() - 1);
        table[code] = static_cast<float>(is_srgb ? linear_from_srgb(coded) : std::pow(coded, 1 / gamma));
    }
    return table;
}

// --- Writing -------------------------------------------------------------------------------------------------------

struct PngWriter {
    PngWriter() {
        png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, on_error, on_warning);
        info = png != nullptr ? png_create_info_struct(png) : nullptr;
    }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
    ~PngWriter() { png_destroy_write_struct(&png, &info); }

    Bytes bytes;
    PngError error;
    png_structp png = nullptr;
    png_infop info = nullptr;
};

/// Whether it could; an exception must not cross libpng.
bool append(Bytes& bytes, const png_byte* source, std::size_t size) noexcept try {
    const auto* first = reinterpret_cast<const std::byte*>(source);
    bytes.insert(bytes.end(), first, first + size);
    return true;
} catch (...) {
    return false;
}

void write_bytes(png_structp png, png_bytep source, std::size_t size) {
    if (!append(static_cast<PngWriter*>(png_get_io_ptr(png))->bytes, source, size)) png_error(png, "not enough memory");
}

void flush_nothing(png_structp) {}

/// Jumps.
bool write_file(PngWriter& writer, const Image& image, png_const_bytep codes, std::vector<png_text>& texts) {
    if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
    png_set_write_fn(writer.png, &writer, write_bytes, flush_nothing);
    png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
                 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_text(writer.png, writer.info, texts.data(), static_cast<int>(texts.size()));
    png_write_info(writer.png, writer.info);
    for (std::int64_t y = 0; y < image.height; ++y) png_write_row(writer.png, codes + y * image.width * 3);
    png_write_end(writer.png, nullptr);
    return true;
}

png_byte srgb_code(float linear) {
    if (!(linear > 0)) return 0;  // NaN as well
    if (linear >= 1) return 255;
    return static_cast<png_byte>(std::lround(srgb_from_linear(linear) * 255));
}

png_text text_chunk(const std::string& name, const std::string& value) {
    const bool is_ascii = std::all_of(value.begin(), value.end(), [](unsigned char c) { return c > 0 && c < 0x80; });
    png_text text{};
    text.compression = is_ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;  // tEXt is Latin-1, iTXt UTF-8
    text.key = const_cast<char*>(name.c_str());
    text.text = const_cast<char*>(value.c_str());
    return text;
}

}  // namespace

ImageContents decode_png(BytesView bytes, std::int64_t max_side, std::int64_t max_pixels) {
    check_chunks(bytes);
    PngReader reader(bytes);
    const auto check = [&](bool is_ok) {
        if (!is_ok) throw std::runtime_error(reader.error.text);
    };
    check(reader.info != nullptr);
    check(read_header(reader));
    const std::int64_t width = png_get_image_width(reader.png, reader.info);
    const std::int64_t height = png_get_image_height(reader.png, reader.info);
    check_image_size(width, height, max_side, max_pixels);

    // Deflate makes at most 258 bytes out of 2 bits.
    const std::int64_t row_bits =
        width * png_get_channels(reader.png, reader.info) * png_get_bit_depth(reader.png, reader.info);
    if (row_bits / 8 * height / 1032 > std::ssize(bytes)) throw std::runtime_error("the file ends too early");

    std::vector<std::string> left_out;
    if ((png_get_color_type(reader.png, reader.info) & PNG_COLOR_MASK_ALPHA) != 0 ||
        png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0)
        left_out.emplace_back("alpha");
    if (png_get_valid(reader.png, reader.info, PNG_INFO_iCCP) != 0) left_out.emplace_back("a colour profile");

    std::string primaries = primaries_of(reader);

    check(convert_to_rgb(reader));
    const int bit_depth = png_get_bit_depth(reader.png, reader.info);
    const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
    const std::size_t value_count = static_cast<std::size_t>(width * height * 3);
    if (row_bytes * 8 != static_cast<std::size_t>(width * 3 * bit_depth)) throw std::logic_error("unexpected row size");
    std::vector<png_byte> codes(row_bytes * static_cast<std::size_t>(height));
    std::vector<png_bytep> rows(static_cast<std::size_t>(height));
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = codes.data() + y * row_bytes;
    check(read_rows(reader, rows.data()));

    const std::vector<float> linear = decoding_table(reader, bit_depth);
    Image image(width, height);
    for (std::size_t i = 0; i < value_count; ++i) {
        const int code = bit_depth == 8 ? codes[i] : codes[2 * i] << 8 | codes[2 * i + 1];
        image.rgb[i] = linear[static_cast<std::size_t>(code)];
    }
    ImageContents contents = whole(std::move(image));
    contents.left_out = std::move(left_out);
    contents.primaries = std::move(primaries);
    return contents;
}

Bytes encode_png(const Image& image, const ImageAttributes& attributes) {
    std::vector<png_byte> codes(image.rgb.size());
    std::transform(image.rgb.begin(), image.rgb.end(), codes.begin(), srgb_code);
    std::vector<png_text> texts;
    for (const auto& [name, value] : attributes) texts.push_back(text_chunk(name, value));

    PngWriter writer;
    if (writer.info == nullptr || !write_file(writer, image, codes.data(), texts)) {
        throw std::runtime_error(writer.error.text);
    }
    return std::move(writer.bytes);
}

}  // namespace raypool
