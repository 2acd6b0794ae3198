/// OpenEXR files in memory, through OpenEXR 2.4 or later.
/// Layout of a header: https://openexr.com/en/latest/OpenEXRFileLayout.html

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>

#include <algorithm>
#include <array>
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/image/exr_header.h"
#include "core/image/exr_layer.h"
#include "core/image/exr_streams.h"
#include "core/image/image_codecs.h"

namespace raypool {
namespace {

const std::array<std::string, 3> kChannels{"R", "G", "B"};
constexpr std::size_t kPixelBytes = 3 * sizeof(float);

using Window = std::remove_cvref_t<decltype(std::declval<Imf::Header>().dataWindow())>;

std::int64_t width_of(const Window& window) {
    return std::int64_t{window.max.x} - window.min.x + 1;
}
std::int64_t height_of(const Window& window) {
    return std::int64_t{window.max.y} - window.min.y + 1;
}

/// Rows that OpenEXR holds at a time: those of a tile, or of a block of scan lines at the most.
std::int64_t rows_of_block(const Imf::Header& header) {
    if (header.hasTileDescription()) return header.tileDescription().ySize;
    return header.compression() == Imf::DWAB_COMPRESSION ? 256 : 32;
}

/// Checks what OpenEXR would take at its word when it reserves memory for a part of a file of so many bytes; returns
/// the number of chunks.
std::int64_t check_part(const Imf::Header& header, std::int64_t channel_count, std::int64_t file_bytes,
                        const ImageLimits& limits) {
    const std::int64_t width = width_of(header.dataWindow());
    const std::int64_t height = height_of(header.dataWindow());
    check_image_size(width, height, limits.side, limits.pixels);
    std::int64_t block_width = width;
    std::int64_t chunk_count = 0;
    if (header.hasTileDescription()) {
        const Imf::TileDescription& tile = header.tileDescription();
        if (tile.xSize < 1 || tile.ySize < 1 || tile.xSize > kMaxImageSide || tile.ySize > kMaxImageSide)
            throw std::runtime_error(fmt::format("tiles must have edges within [1, {}], got {} x {}", kMaxImageSide,
                                                 tile.xSize, tile.ySize));
        const std::int64_t columns = (width + tile.xSize - 1) / tile.xSize;
        const std::int64_t rows = (height + tile.ySize - 1) / tile.ySize;
        chunk_count = columns * rows;
        block_width = columns * tile.xSize;
    } else {
        chunk_count = height / rows_of_block(header);
    }
    if (header.hasChunkCount()) {
        if (header.chunkCount() < 0) throw std::runtime_error("the number of chunks must not be negative");
        chunk_count = std::max<std::int64_t>(chunk_count, header.chunkCount());
    }
    const std::int64_t most_values = std::max(kMaxExrBlockValues, kMaxExrExpansion * file_bytes);
    if (block_width * channel_count * rows_of_block(header) > most_values)
        throw std::runtime_error(
            fmt::format("a block of rows must have at most {} values, got {} columns of {} channels in {} rows",
                        most_values, block_width, channel_count, rows_of_block(header)));
    return chunk_count;
}

/// Returns what MemoryInput is to hide.
std::vector<std::size_t> check_headers(BytesView bytes, const ImageLimits& limits) {
    constexpr std::int64_t kLeastChunkBytes = 8;  // its place in the table of chunks
    ExrHeader headers = check_exr_header(bytes);
    MemoryInput stream(bytes, headers.hidden);
    stream.seekg(sizeof kExrMagic + sizeof headers.version);
    std::int64_t chunk_count = 0;  // of all parts, since each has a table
    for (const std::int64_t channel_count : headers.channel_counts) {
        Imf::Header header;
        header.readFrom(stream, headers.version);
        chunk_count += check_part(header, channel_count, std::ssize(bytes), limits);
        if (chunk_count > std::ssize(bytes) / kLeastChunkBytes) throw std::runtime_error("the file ends too early");
    }
    return std::move(headers.hidden);
}

/// The three channels of the rows in `window`, stored from `first` on.
Imf::FrameBuffer frame_buffer(const std::array<std::string, 3>& channels, float* first, const Window& window) {
    const std::size_t row_bytes = static_cast<std::size_t>(width_of(window)) * kPixelBytes;
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        if (i > 0 && channels[i] == channels[0]) break;  // grey: copied afterwards
        buffer.insert(channels[i], Imf::Slice::Make(Imf::FLOAT, first + i, window, kPixelBytes, row_bytes));
    }
    return buffer;
}

/// Calls read(rows, first value) for blocks of rows. Memory grows with the rows that are really there: how far a row
/// may have been compressed depends on the codec. A step is a multiple of the rows in a block.
template <class Read>
Image read_rows(const Imf::Header& header, Read read) {
    const Window window = header.dataWindow();
    Image image;
    image.width = width_of(window);
    image.height = height_of(window);
    const std::int64_t step = rows_of_block(header);
    for (std::int64_t row = 0; row < image.height; row += step) {
        const std::int64_t row_end = std::min(row + step, image.height);
        image.rgb.resize(static_cast<std::size_t>(row_end * image.width * 3));
        Window rows = window;
        rows.min.y = static_cast<int>(window.min.y + row);
        rows.max.y = static_cast<int>(window.min.y + row_end - 1);
        read(rows, image.pixel(0, row));
    }
    return image;
}

Image read_layer(Imf::MultiPartInputFile& file, const ExrLayer& layer) {
    Imf::InputPart part(file, layer.part);
    const bool is_grey = layer.channels[0] == layer.channels[1];
    return read_rows(file.header(layer.part), [&](const Window& rows, float* first) {
        part.setFrameBuffer(frame_buffer(layer.channels, first, rows));
        part.readPixels(rows.min.y, rows.max.y);
        if (!is_grey) return;
        for (float* pixel = first; pixel != first + 3 * width_of(rows) * height_of(rows); pixel += 3)
            pixel[1] = pixel[2] = pixel[0];
    });
}

/// Luminance with chroma of fewer pixels, as OpenEXR turns it into RGB.
Image read_luminance_and_chroma(BytesView bytes, std::span<const std::size_t> hidden, const Imf::Header& header) {
    MemoryInput stream(bytes, hidden);
    Imf::RgbaInputFile file(stream);
    std::vector<Imf::Rgba> pixels;
    return read_rows(header, [&](const Window& rows, float* first) {
        pixels.resize(static_cast<std::size_t>(width_of(rows) * height_of(rows)));
        file.setFrameBuffer(pixels.data() - rows.min.x - static_cast<std::ptrdiff_t>(rows.min.y) * width_of(rows), 1,
                            static_cast<std::size_t>(width_of(rows)));
        file.readPixels(rows.min.y, rows.max.y);
        for (const Imf::Rgba& pixel : pixels) {
            *first++ = pixel.r;
            *first++ = pixel.g;
            *first++ = pixel.b;
        }
    });
}

std::string primaries_of(const Imf::Header& header) {
    const Imf::Chromaticities srgb;
    const Imf::Chromaticities own = Imf::hasChromaticities(header) ? Imf::chromaticities(header) : srgb;
    if (own.red == srgb.red && own.green == srgb.green && own.blue == srgb.blue && own.white == srgb.white)
        return "sRGB";
    return fmt::format("red {:g} {:g}, green {:g} {:g}, blue {:g} {:g}, white {:g} {:g}", own.red.x, own.red.y,
                       own.green.x, own.green.y, own.blue.x, own.blue.y, own.white.x, own.white.y);
}

PixelWindow pixel_window(const Window& window) {
    return {window.min.x, std::int64_t{window.max.x} + 1, window.min.y, std::int64_t{window.max.y} + 1};
}

}  // namespace

Bytes encode_exr(const Image& image, const ImageAttributes& attributes, const ExrExtras& extras) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, value] : attributes) header.insert(name.c_str(), Imf::StringAttribute(value));

    // Halves are made here of floats, since OpenEXR changes no types when it writes.
    Imf::FrameBuffer buffer;
    std::deque<std::vector<half>> halves;
    const auto add = [&](const std::string& name, const float* first, std::size_t stride, bool is_half) {
        header.channels().insert(name, Imf::Channel(is_half ? Imf::HALF : Imf::FLOAT));
        const auto width = static_cast<std::size_t>(image.width);
        if (!is_half) {
            buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, first, header.dataWindow(), stride * sizeof(float),
                                                 width * stride * sizeof(float)));
            return;
        }
        std::vector<half>& values = halves.emplace_back(width * static_cast<std::size_t>(image.height));
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = half(first[i * stride]);
        buffer.insert(
            name, Imf::Slice::Make(Imf::HALF, values.data(), header.dataWindow(), sizeof(half), width * sizeof(half)));
    };
    for (std::size_t k = 0; k < kChannels.size(); ++k) add(kChannels[k], image.rgb.data() + k, 3, extras.is_half);
    for (const ImageChannel& channel : extras.channels)
        add(channel.name, channel.values.data(), 1, extras.is_half && channel.may_be_half);

    MemoryOutput stream;
    {
        Imf::OutputFile file(stream, header);  // complete only after its destructor
        file.setFrameBuffer(buffer);
        file.writePixels(static_cast<int>(image.height));
    }
    return std::move(stream.bytes);
}

ImageContents decode_exr(BytesView bytes, const ImageLimits& limits) {
    const std::vector<std::size_t> hidden = check_headers(bytes, limits);
    MemoryInput stream(bytes, hidden);
    Imf::MultiPartInputFile file(stream);
    const ExrLayer layer = find_layer(file);
    const Imf::Header& header = file.header(layer.part);
    const Window& display = header.displayWindow();  // a caller may fill it
    check_image_size(width_of(display), height_of(display), kMaxImageSide, kMaxImagePixels,
                     "width and height of the display window");

    ImageContents contents;
    contents.data_window = pixel_window(header.dataWindow());
    contents.display_window = pixel_window(display);
    contents.left_out = left_out(file, layer);
    contents.primaries = primaries_of(header);
    for (auto entry = header.begin(); entry != header.end(); ++entry) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&entry.attribute());
        const bool is_of_format = std::string_view(entry.name()) == "type" || std::string_view(entry.name()) == "name";
        if (text != nullptr && !is_of_format) contents.attributes.emplace(entry.name(), text->value());
    }
    contents.image = layer.has_chroma ? read_luminance_and_chroma(bytes, hidden, header) : read_layer(file, layer);
    return contents;
}

}  // namespace raypool
