#include "core/image/exr_header.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

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

std::int64_t count_channels(Walk& value) {
    constexpr std::size_t kChannelBytes = 16;  // type, linearity and sampling
    std::int64_t count = 0;
    while (!value.take_name().empty()) {
        value.take(kChannelBytes);
        ++count;
    }
    return count;
}

void take_preview(Walk& value) {
    constexpr std::size_t kTexelBytes = 4;
    const auto width = static_cast<std::uint32_t>(value.take_int());
    const auto height = static_cast<std::uint32_t>(value.take_int());
    const std::uint64_t texels = std::uint64_t{width} * height;
    value.take(texels > SIZE_MAX / kTexelBytes ? SIZE_MAX : texels * kTexelBytes);
}

/// Takes what OpenEXR would take for a value of the type. False if the type is none that all its versions read alike.
bool take_value(std::string_view type, Walk& value, std::size_t size, std::int64_t& channel_count) {
    const auto* const fixed = std::find_if(kFixedTypes.begin(), kFixedTypes.end(),
                                           [&](const FixedType& candidate) { return candidate.name == type; });
    if (fixed != kFixedTypes.end()) {
        value.take(fixed->size);
    } else if (type == "chlist") {
        channel_count += count_channels(value);
    } else if (type == "floatvector") {
        value.take(size - size % sizeof(float));
    } else if (type == "stringvector") {
        while (!value.is_at_end()) value.take_sized();
    } else if (type == "preview") {
        take_preview(value);
    } else {
        value.take(size);
        return type == "string";
    }
    return true;
}

/// The attributes of a part, up to the empty name behind them. Returns the number of channels; notes the types that
/// are to be hidden, by their place after `begin`.
std::int64_t take_part(Walk& walk, std::string_view first_name, const char* begin, std::vector<std::size_t>& hidden) {
    std::int64_t channel_count = 0;
    for (std::string_view name = first_name; !name.empty(); name = walk.take_name()) {
        const std::string_view type = walk.take_name();
        const std::string_view content = walk.take_sized();
        Walk value(content);
        if (!take_value(type, value, content.size(), channel_count) && !type.empty())
            hidden.push_back(static_cast<std::size_t>(type.data() - begin));
        if (!value.is_at_end()) throw std::runtime_error("an attribute is longer than its type");
    }
    return channel_count;
}

}  // namespace

ExrHeader check_exr_header(BytesView bytes) {
    constexpr std::int32_t kNumber = 0xff;
    constexpr std::int32_t kManyParts = 0x1000;
    constexpr std::int32_t kKnownFlags = 0x200 | 0x400 | 0x800 | kManyParts;  // tiles, long names, deep data
    const auto* const begin = reinterpret_cast<const char*>(bytes.data());
    Walk walk({begin, bytes.size()});
    if (walk.take_int() != kExrMagic) throw std::runtime_error("not an EXR file");
    ExrHeader header{walk.take_int(), {}, {}};
    if ((header.version & kNumber) != 2 || (header.version & ~(kNumber | kKnownFlags)) != 0)
        throw std::runtime_error("of a version of EXR that is not read");
    if ((header.version & kManyParts) == 0) {
        header.channel_counts.push_back(take_part(walk, walk.take_name(), begin, header.hidden));
        return header;
    }
    for (std::string_view name = walk.take_name(); !name.empty(); name = walk.take_name())
        header.channel_counts.push_back(take_part(walk, name, begin, header.hidden));
    return header;
}

}  // namespace raypool
