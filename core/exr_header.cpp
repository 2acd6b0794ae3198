#include "core/exr_header.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "core/exr_stream.h"

namespace raypool {
namespace {

/// Reads the front of a text piece by piece; a piece that is not all there throws.
class Walk {
  public:
    explicit Walk(std::string_view text) : rest_(text) {}

    [[nodiscard]] bool is_at_end() const { return rest_.empty(); }
    std::string_view take(std::size_t size) {
        if (size > rest_.size()) throw std::runtime_error("the file ends too early");
        const std::string_view piece = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return piece;
    }
    std::string_view take_name() {
        const std::string_view name = take(std::min(rest_.find('\0'), rest_.size()));
        take(1);
        return name;
    }
    std::int32_t take_int() {
        std::int32_t value = 0;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    /// A size that is negative is too large.
    std::string_view take_sized() { return take(static_cast<std::size_t>(take_int())); }

  private:
    std::string_view rest_;
};

struct FixedType {
    std::string_view name;
    std::size_t size;
};
constexpr std::array<FixedType, 24> kFixedTypes{{{"box2f", 16},
                                                 {"box2i", 16},
                                                 {"chromaticities", 32},
                                                 {"compression", 1},
                                                 {"deepImageState", 1},
                                                 {"double", 8},
                                                 {"envmap", 1},
                                                 {"float", 4},
                                                 {"int", 4},
                                                 {"keycode", 28},
                                                 {"lineOrder", 1},
                                                 {"m33d", 72},
                                                 {"m33f", 36},
                                                 {"m44d", 128},
                                                 {"m44f", 64},
                                                 {"rational", 8},
                                                 {"tiledesc", 9},
                                                 {"timecode", 8},
                                                 {"v2d", 16},
                                                 {"v2f", 8},
                                                 {"v2i", 8},
                                                 {"v3d", 24},
                                                 {"v3f", 12},
                                                 {"v3i", 12}}};

void take_channels(Walk& value) {
    constexpr std::size_t kChannelBytes = 16;  // type, linearity and sampling
    while (!value.take_name().empty()) value.take(kChannelBytes);
}

void take_preview(Walk& value) {
    constexpr std::size_t kTexelBytes = 4;
    const auto width = static_cast<std::uint32_t>(value.take_int());
    const auto height = static_cast<std::uint32_t>(value.take_int());
    const std::uint64_t texels = std::uint64_t{width} * height;
    value.take(texels > SIZE_MAX / kTexelBytes ? SIZE_MAX : texels * kTexelBytes);
}

/// Takes what OpenEXR would take for a value of the type. False if the type is none of those it reads alike in all its
/// versions.
bool take_value(std::string_view type, Walk& value, std::size_t size) {
    const auto* const fixed = std::find_if(kFixedTypes.begin(), kFixedTypes.end(),
                                           [&](const FixedType& candidate) { return candidate.name == type; });
    if (fixed != kFixedTypes.end()) {
        value.take(fixed->size);
    } else if (type == "chlist") {
        take_channels(value);
    } else if (type == "floatvector") {
        value.take(size - size % sizeof(float));
    } else if (type == "stringvector") {
        while (!value.is_at_end()) value.take_sized();
    } else if (type == "preview") {
        take_preview(value);
    } else if (type == "string") {
        value.take(size);
    } else {
        value.take(size);
        return false;
    }
    return true;
}

/// Checks all attributes, notes the types that OpenEXR must not see; returns the version with its flags.
std::int32_t check_attributes(BytesView bytes, std::vector<std::size_t>& hidden) {
    const auto* const begin = reinterpret_cast<const char*>(bytes.data());
    Walk walk({begin, bytes.size()});
    if (walk.take_int() != Imf::MAGIC) throw std::runtime_error("not an EXR file");
    const std::int32_t version = walk.take_int();
    if (Imf::getVersion(version) != 2 || !Imf::supportsFlags(Imf::getFlags(version))) {
        throw std::runtime_error("must be of version 2 and have no flags beyond it");
    }
    const bool is_multi_part = Imf::isMultiPart(version);
    for (std::string_view name = walk.take_name(); !name.empty(); name = is_multi_part ? walk.take_name() : "") {
        for (; !name.empty(); name = walk.take_name()) {
            const std::string_view type = walk.take_name();
            const std::string_view content = walk.take_sized();
            Walk value(content);
            if (!take_value(type, value, content.size()) && !type.empty()) {
                hidden.push_back(static_cast<std::size_t>(type.data() - begin));
            }
            if (!value.is_at_end()) throw std::runtime_error("an attribute is longer than its type");
        }
    }
    return version;
}

std::int64_t divided_up(std::int64_t a, std::int64_t b) {
    return (a + b - 1) / b;
}

/// Checks the sizes that the part claims; returns the number of its chunks, tiles of other levels aside.
std::int64_t check_sizes(const ExrPart& part, std::size_t file_size) {
    const auto& window = part.header.dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    check_image_size(width, height, kMaxImageSide);

    std::int64_t pixel_bytes = 0;
    const Imf::ChannelList& channels = part.header.channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        pixel_bytes += channel.channel().type == Imf::HALF ? 2 : 4;
    }
    std::int64_t chunk_width = width;
    std::int64_t chunk_height = rows_per_chunk(part.header);
    if (part.is_tiled) {
        if (!part.header.hasTileDescription()) throw std::runtime_error("tiles without a description of them");
        chunk_width = part.header.tileDescription().xSize;
        chunk_height = part.header.tileDescription().ySize;
        if (chunk_width < 1 || chunk_width > kMaxImageSide || chunk_height < 1 || chunk_height > kMaxImageSide) {
            throw std::runtime_error(fmt::format("a tile's sides must be within [1, {}]", kMaxImageSide));
        }
    }
    const std::int64_t most = std::max(std::int64_t{1} << 28, 1024 * static_cast<std::int64_t>(file_size));
    if (pixel_bytes * chunk_width > most / chunk_height) {
        throw std::runtime_error(
            fmt::format("{} x {} pixels of {} bytes are compressed together: must be at most "
                        "256 MiB, or 1024 times the file",
                        chunk_width, chunk_height, pixel_bytes));
    }
    constexpr std::int64_t kReadBytes = 3 * sizeof(float);
    if (part.is_tiled && width * kReadBytes > most / chunk_height) {
        throw std::runtime_error("a row of tiles must take at most 256 MiB, or 1024 times the file");
    }
    return std::max(divided_up(width, chunk_width) * divided_up(height, chunk_height),
                    std::int64_t{part.header.hasChunkCount() ? part.header.chunkCount() : 0});
}

}  // namespace

std::int64_t rows_per_chunk(const Imf::Header& header) {
    switch (header.compression()) {
        case Imf::NO_COMPRESSION:
        case Imf::RLE_COMPRESSION:
        case Imf::ZIPS_COMPRESSION:
            return 1;
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION:
            return 16;
        case Imf::DWAB_COMPRESSION:
            return 256;
        default:
            return 32;
    }
}

ExrHeaders read_exr_headers(BytesView bytes) {
    ExrHeaders headers;
    int version = check_attributes(bytes, headers.hidden);
    MemoryInput stream(bytes, headers.hidden);
    stream.seekg(sizeof Imf::MAGIC + sizeof version);
    std::int64_t chunk_count = 0;
    do {
        Imf::Header header;
        header.readFrom(stream, version);
        if (header.readsNothing()) break;
        ExrPart part{header, Imf::isNonImage(version), Imf::isTiled(version)};
        if (header.hasType()) part.is_deep = Imf::isDeepData(header.type());
        if (Imf::isMultiPart(version) && header.hasType()) part.is_tiled = Imf::isTiled(header.type());
        chunk_count += check_sizes(part, bytes.size());
        headers.parts.push_back(std::move(part));
    } while (Imf::isMultiPart(version));
    if (headers.parts.empty()) throw std::runtime_error("must have at least one part");
    if (chunk_count > static_cast<std::int64_t>(bytes.size() / sizeof(std::uint64_t))) {
        throw std::runtime_error("the file ends too early for its number of blocks");
    }
    return headers;
}

}  // namespace raypool
