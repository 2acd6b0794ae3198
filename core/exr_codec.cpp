/// OpenEXR files in memory, through OpenEXR 2.4 or later.
/// Layout of a header: https://openexr.com/en/latest/OpenEXRFileLayout.html

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "core/exr_header.h"
#include "core/image_codecs.h"

namespace raypool {
namespace {

using StreamPosition = decltype(std::declval<Imf::OStream&>().tellp());  // its type changed in version 3
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

class MemoryInput final : public Imf::IStream {
  public:
    explicit MemoryInput(BytesView bytes) : IStream("the file"), bytes_(bytes) {}

    bool read(char target[], int size) override {
        if (position_ > bytes_.size() || static_cast<std::size_t>(size) > bytes_.size() - position_) {
            throw std::runtime_error("the file ends too early");
        }
        std::memcpy(target, bytes_.data() + position_, static_cast<std::size_t>(size));
        position_ += static_cast<std::size_t>(size);
        return position_ < bytes_.size();
    }
    StreamPosition tellg() override { return position_; }
    void seekg(StreamPosition position) override { position_ = position; }

  private:
    BytesView bytes_;
    std::size_t position_ = 0;
};

/// Checks what OpenEXR would take at its word when it reserves memory: attributes, and the sizes of rows and image.
void check_header(BytesView bytes) {
    auto [version, channel_count] = check_exr_header(bytes);
    MemoryInput stream(bytes);
    stream.seekg(sizeof kExrMagic + sizeof version);
    Imf::Header header;
    header.readFrom(stream, version);
    const auto& window = header.dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    check_image_size(width, std::int64_t{window.max.y} - window.min.y + 1, kMaxImageSide);
    constexpr std::int64_t kMostRowValues = std::int64_t{1} << 20;  // a codec may want 256 rows at once
    if (width * channel_count > kMostRowValues) throw std::runtime_error("too many channels for its width");
}

/// The three channels of the rows in `window`, stored from `first` on.
template <class Window>
Imf::FrameBuffer frame_buffer(const float* first, const Window& window) {
    const std::size_t row_bytes = static_cast<std::size_t>(window.max.x - window.min.x + 1) * kPixelBytes;
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < kChannels.size(); ++i) {
        buffer.insert(kChannels[i], Imf::Slice::Make(Imf::FLOAT, first + i, window, kPixelBytes, row_bytes));
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

}  // namespace

Bytes encode_exr(const Image& image, const ImageAttributes& attributes) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* channel : kChannels) header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    for (const auto& [name, value] : attributes) header.insert(name.c_str(), Imf::StringAttribute(value));

    MemoryOutput stream;
    {
        Imf::OutputFile file(stream, header);  // complete only after its destructor
        file.setFrameBuffer(frame_buffer(image.rgb.data(), header.dataWindow()));
        file.writePixels(static_cast<int>(image.height));
    }
    return std::move(stream.bytes);
}

ImageContents decode_exr(BytesView bytes) {
    check_header(bytes);
    MemoryInput stream(bytes);
    Imf::InputFile file(stream);
    for (const char* channel : kChannels) {
        if (file.header().channels().findChannel(channel) == nullptr) {
            throw std::runtime_error("must have channels R, G and B");
        }
    }
    const auto window = file.header().dataWindow();
    Image image;
    image.width = std::int64_t{window.max.x} - window.min.x + 1;
    image.height = std::int64_t{window.max.y} - window.min.y + 1;

    // Memory grows with the rows that are really there: how far a row may have been compressed depends on the codec.
    // A step is a multiple of the rows in a block.
    const std::int64_t rows_per_step = file.header().compression() == Imf::DWAB_COMPRESSION ? 256 : 32;
    for (std::int64_t row = 0; row < image.height; row += rows_per_step) {
        const std::int64_t row_end = std::min(row + rows_per_step, image.height);
        image.rgb.resize(static_cast<std::size_t>(row_end * image.width * 3));
        auto rows = window;
        rows.min.y = static_cast<int>(window.min.y + row);
        rows.max.y = static_cast<int>(window.min.y + row_end - 1);
        file.setFrameBuffer(frame_buffer(image.pixel(0, row), rows));
        file.readPixels(rows.min.y, rows.max.y);
    }
    ImageContents contents;
    contents.image = std::move(image);
    contents.data_window = window_of(window);
    contents.display_window = window_of(file.header().displayWindow());
    for (auto channel = file.header().channels().begin(); channel != file.header().channels().end(); ++channel) {
        if (std::find_if(kChannels.begin(), kChannels.end(),
                         [&](const char* name) { return std::strcmp(name, channel.name()) == 0; }) == kChannels.end())
            contents.unread_channels.emplace_back(channel.name());
    }
    contents.chromaticities = chromaticities_of(file.header());
    contents.attributes = text_attributes(file.header());
    return contents;
}

ImageAttributes decode_exr_attributes(BytesView bytes) {
    check_header(bytes);
    MemoryInput stream(bytes);
    const Imf::InputFile file(stream);
    return text_attributes(file.header());
}

}  // namespace raypool
