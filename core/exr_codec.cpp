/// OpenEXR files in memory, through OpenEXR 2.4 or later.
/// Layout of a header: https://openexr.com/en/latest/OpenEXRFileLayout.html

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledInputPart.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "core/exr_header.h"
#include "core/exr_layer.h"
#include "core/exr_stream.h"
#include "core/image_codecs.h"

namespace raypool {
namespace {

constexpr std::array<const char*, 3> kChannels{"R", "G", "B"};
constexpr std::size_t kPixelBytes = 3 * sizeof(float);

class MemoryOutput final : public Imf::OStream {
  public:
    MemoryOutput() : OStream("the file") {}

    void write(const char data[], int size) override {
        const std::size_t end = position_ + static_cast<std::size_t>(size);
        if (end > bytes.size()) bytes.resize(end);
        std::memcpy(bytes.data() + position_, data, static_cast<std::size_t>(size));
        position_ = end;
    }
    StreamPosition tellp() override { return position_; }
    void seekp(StreamPosition position) override { position_ = position; }

    Bytes bytes;

  private:
    std::size_t position_ = 0;
};

/// The channels of the rows in `window`, stored from `first` on, three floats a pixel.
template <class Window>
Imf::FrameBuffer frame_buffer(const std::vector<std::string>& channels, const float* first, const Window& window) {
    const std::size_t row_bytes = static_cast<std::size_t>(window.max.x - window.min.x + 1) * kPixelBytes;
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        buffer.insert(channels[i], Imf::Slice::Make(Imf::FLOAT, first + i, window, kPixelBytes, row_bytes));
    }
    return buffer;
}

template <class Window>
ImageWindow window_of(const Window& window) {
    return {window.min.x, window.min.y, std::int64_t{window.max.x} - window.min.x + 1,
            std::int64_t{window.max.y} - window.min.y + 1};
}

std::optional<Chromaticities> chromaticities_of(const Imf::Header& header) {
    if (!Imf::hasChromaticities(header)) return {};
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    const Chromaticities xy{c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
    if (are_srgb(xy)) return {};
    return xy;
}

ImageAttributes text_attributes(const Imf::Header& header) {
    ImageAttributes attributes;
    for (auto entry = header.begin(); entry != header.end(); ++entry) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&entry.attribute());
        if (text != nullptr) attributes.emplace(entry.name(), text->value());
    }
    return attributes;
}

/// Colour and luminance are read at every pixel, chroma at every other one both ways.
void check_sampling(const Imf::Header& header, const ExrLayer& layer) {
    for (const std::string& name : layer.channels()) {
        const bool is_chroma = layer.kind == ExrLayer::Kind::LuminanceAndChroma && name != layer.channel("Y");
        const int wanted = is_chroma ? 2 : 1;
        const Imf::Channel& channel = header.channels()[name];
        if (channel.xSampling != wanted || channel.ySampling != wanted) {
            throw std::runtime_error(fmt::format("channel {} must be sampled every {} pixels, got {} x {}", name,
                                                 wanted, channel.xSampling, channel.ySampling));
        }
    }
}

// Memory grows with the rows that are really there: how far a row may have been compressed depends on the codec.

void read_rows(Imf::MultiPartInputFile& file, const ExrLayer& layer, Image& image) {
    Imf::InputPart part(file, static_cast<int>(layer.part));
    const auto window = part.header().dataWindow();
    const std::int64_t rows_per_step = std::max<std::int64_t>(rows_per_chunk(part.header()), 32);
    for (std::int64_t row = 0; row < image.height; row += rows_per_step) {
        const std::int64_t row_end = std::min(row + rows_per_step, image.height);
        image.rgb.resize(static_cast<std::size_t>(row_end * image.width * 3));
        auto rows = window;
        rows.min.y = static_cast<int>(window.min.y + row);
        rows.max.y = static_cast<int>(window.min.y + row_end - 1);
        part.setFrameBuffer(frame_buffer(layer.channels(), image.pixel(0, row), rows));
        part.readPixels(rows.min.y, rows.max.y);
    }
}

void read_tiles(Imf::MultiPartInputFile& file, const ExrLayer& layer, Image& image) {
    Imf::TiledInputPart part(file, static_cast<int>(layer.part));
    const auto window = part.header().dataWindow();
    for (int tile = 0; tile < part.numYTiles(); ++tile) {
        auto rows = part.dataWindowForTile(0, tile);
        rows.max.x = window.max.x;
        const std::int64_t row = std::int64_t{rows.min.y} - window.min.y;
        image.rgb.resize(static_cast<std::size_t>((row + rows.max.y - rows.min.y + 1) * image.width * 3));
        part.setFrameBuffer(frame_buffer(layer.channels(), image.pixel(0, row), rows));
        part.readTiles(0, part.numXTiles() - 1, tile, tile);
    }
}

/// In half precision, which is all that OpenEXR's own conversion gives.
void read_chroma(MemoryInput& stream, const ExrLayer& layer, Image& image) {
    Imf::RgbaInputFile file(stream, layer.layer, 0);
    const auto window = file.dataWindow();
    std::vector<Imf::Rgba> row(static_cast<std::size_t>(image.width));
    file.setFrameBuffer(row.data() - window.min.x, 1, 0);
    for (int y = window.min.y; y <= window.max.y; ++y) {
        file.readPixels(y);
        for (const Imf::Rgba& pixel : row) image.rgb.insert(image.rgb.end(), {pixel.r, pixel.g, pixel.b});
    }
}

}  // namespace

Bytes encode_exr(const Image& image, const ImageAttributes& attributes) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* channel : kChannels) header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    for (const auto& [name, value] : attributes) header.insert(name.c_str(), Imf::StringAttribute(value));

    MemoryOutput stream;
    {
        Imf::OutputFile file(stream, header);  // complete only after its destructor
        file.setFrameBuffer(frame_buffer({kChannels.begin(), kChannels.end()}, image.rgb.data(), header.dataWindow()));
        file.writePixels(static_cast<int>(image.height));
    }
    return std::move(stream.bytes);
}

ImageContents decode_exr(BytesView bytes) {
    const ExrHeaders headers = read_exr_headers(bytes);
    const std::vector<ExrPart>& parts = headers.parts;
    const ExrLayer layer = exr_layer(parts);
    const ExrPart& part = parts[layer.part];
    const bool has_chroma = layer.kind == ExrLayer::Kind::LuminanceAndChroma;
    check_sampling(part.header, layer);
    if (has_chroma && parts.size() > 1)
        throw std::runtime_error("luminance and chroma must not be one part of several");

    ImageContents contents;
    contents.image.width = window_of(part.header.dataWindow()).width;
    contents.image.height = window_of(part.header.dataWindow()).height;
    MemoryInput stream(bytes, headers.hidden);
    if (has_chroma) {
        read_chroma(stream, layer, contents.image);
    } else {
        constexpr int kNoThreads = 0;
        constexpr bool kMendsTable = true;
        Imf::MultiPartInputFile file(stream, kNoThreads, !kMendsTable);  // what a table lacks, the file lacks
        if (part.is_tiled) {
            read_tiles(file, layer, contents.image);
        } else {
            read_rows(file, layer, contents.image);
        }
    }
    if (layer.kind == ExrLayer::Kind::Luminance) {
        std::vector<float>& rgb = contents.image.rgb;
        for (std::size_t i = 0; i < rgb.size(); i += 3) rgb[i + 1] = rgb[i + 2] = rgb[i];
    }
    contents.data_window = window_of(part.header.dataWindow());
    contents.display_window = window_of(part.header.displayWindow());
    contents.unread_channels = other_channels(parts, layer);
    contents.chromaticities = chromaticities_of(part.header);
    contents.attributes = text_attributes(part.header);
    return contents;
}

ImageAttributes decode_exr_attributes(BytesView bytes) {
    return text_attributes(read_exr_headers(bytes).parts[0].header);
}

}  // namespace raypool
