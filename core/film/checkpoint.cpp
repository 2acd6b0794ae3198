#include "core/film/checkpoint.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <xxhash.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_file.h"
#include "core/base/json_parser.h"
#include "core/base/output_file.h"

namespace raypool {

namespace {

using nlohmann::json;

constexpr const char* kFormat = "raypool sums";
constexpr int kVersion = 3;
constexpr std::size_t kChecksumLength = 16;
constexpr std::size_t kMostHeaderBytes = 1 << 20;
constexpr std::int64_t kMostPixels = std::int64_t{1} << 32;

std::string checksum(std::string_view bytes) {
    return fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
}

json header_of(const Checkpoint& sums) {
    const Framebuffer& framebuffer = sums.framebuffer;
    json key = json::array();
    for (const auto& [name, value] : sums.key) key.push_back({name, value});
    json ranges = json::array();
    for (const SampleRange& range : sums.ranges) ranges.push_back({range.first, range.end});
    const FixedPoint& fixed = framebuffer.fixed_point();
    return {{"format", kFormat},
            {"version", kVersion},
            {"key", key},
            {"spp", sums.spp},
            {"ranges", ranges},
            {"rounds", sums.rounds},
            {"width", framebuffer.width()},
            {"height", framebuffer.height()},
            {"fraction_bits", fixed.fraction_bits},
            {"limit_bits", std::ilogb(fixed.limit)},
            {"has_halves", framebuffer.has_halves()},
            {"has_counts", !sums.sample_counts.empty()}};
}

template <class T>
void append(std::string& text, std::span<const T> values) {
    text.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

/// Takes values off the front of `bytes`, which has enough.
template <class T>
void take(std::string_view& bytes, std::span<T> values) {
    if (values.empty()) return;  // which may have no address
    std::memcpy(values.data(), bytes.data(), values.size_bytes());
    bytes.remove_prefix(values.size_bytes());
}

/// The whole file; of one that does not begin with a line only the beginning, which is refused.
std::string read_bytes(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
        throw InputError(fmt::format("{}: not a file", path.string()));  // a device may never end
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InputError(fmt::format("{}: cannot open: {}", path.string(), std::strerror(errno)));
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw InputError(fmt::format("{}: cannot read: {}", path.string(), error.message()));
    std::string bytes(std::min<std::uintmax_t>(size, kMostHeaderBytes), '\0');
    const auto read_on = [&](std::size_t from) {
        stream.read(bytes.data() + from, static_cast<std::streamsize>(bytes.size() - from));
        if (stream.bad()) throw InputError(fmt::format("{}: cannot read", path.string()));
        bytes.resize(from + static_cast<std::size_t>(stream.gcount()));
    };
    read_on(0);
    if (size > kMostHeaderBytes && bytes.find('\n') != std::string::npos) {
        bytes.resize(size);
        read_on(kMostHeaderBytes);
    }
    return bytes;
}

/// A whole number that is written as one.
std::int64_t whole(const json& value) {
    if (!value.is_number_integer()) throw InputError("a number of its header is not whole");
    return value.get<std::int64_t>();
}

/// A text of the key, which messages repeat.
std::string printable(const json& value) {
    auto text = value.get<std::string>();
    if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }))
        throw InputError("its key has control characters");
    return text;
}

/// Throws json::exception for a header that is not as header_of() makes it.
Checkpoint parsed(const json& header, std::string_view payload) {
    const auto within = [&](const char* name, std::int64_t least, std::int64_t most) {
        const std::int64_t value = whole(header.at(name));
        if (value < least || value > most) throw InputError(fmt::format("{} is {}", name, value));
        return value;
    };
    const std::int64_t width = within("width", 1, kMostPixels);
    const std::int64_t height = within("height", 1, kMostPixels / width);
    const bool has_halves = header.at("has_halves").get<bool>();
    const bool has_counts = header.at("has_counts").get<bool>();
    const auto pixels = static_cast<std::size_t>(width * height);
    const std::size_t bytes = pixels * ((has_halves ? 6 : 3) * sizeof(std::int64_t) + (has_counts ? 4 : 0));
    if (payload.size() != bytes)
        throw InputError(fmt::format("{} bytes of sums in place of {}", payload.size(), bytes));

    const FixedPoint fixed{static_cast<int>(within("fraction_bits", -1100, 1100)),
                           std::ldexp(1.0, static_cast<int>(within("limit_bits", -1000, 1000)))};
    Checkpoint sums{{},
                    within("spp", 1, std::numeric_limits<std::int32_t>::max()),
                    {},
                    std::vector<std::int32_t>(has_counts ? pixels : 0),
                    static_cast<int>(within("rounds", 0, 1 << 30)),
                    Framebuffer(width, height, fixed, has_halves ? Halves::Apart : Halves::Together)};
    for (const json& pair : header.at("key")) sums.key.emplace_back(printable(pair.at(0)), printable(pair.at(1)));
    for (const json& pair : header.at("ranges")) {
        const SampleRange range{whole(pair.at(0)), whole(pair.at(1))};
        if (range.first <= (sums.ranges.empty() ? -1 : sums.ranges.back().end) || range.end <= range.first ||
            range.end > sums.spp)
            throw InputError("its ranges of samples do not rise, are not apart or go beyond spp");
        sums.ranges.push_back(range);
    }
    take(payload, sums.framebuffer.sums());
    take(payload, std::span(sums.sample_counts));
    if (std::any_of(sums.sample_counts.begin(), sums.sample_counts.end(), [](std::int32_t count) { return count < 0; }))
        throw InputError("a pixel has fewer than no samples");
    return sums;
}

/// That have this step.
double most_samples(const FixedPoint& fixed) {
    return std::ldexp(1.0, 62 - std::ilogb(fixed.limit) - fixed.fraction_bits);
}

}  // namespace

std::string difference(const ImageKey& found, const ImageKey& wanted) {
    for (const auto& [name, value] : wanted) {
        const auto same = std::find_if(found.begin(), found.end(),
                                       [&wanted_name = name](const auto& pair) { return pair.first == wanted_name; });
        if (same == found.end()) return fmt::format("no {}", name);
        if (same->second != value) return fmt::format("{} {}, not {}", name, same->second, value);
    }
    return found.size() == wanted.size() ? "" : "settings that are not known here";
}

void check_same_render(const Checkpoint& found, const Checkpoint& wanted) {
    if (const std::string differs = difference(found.key, wanted.key); !differs.empty())
        throw InputError(fmt::format("of a render with {}", differs));
    const Framebuffer& a = found.framebuffer;
    const Framebuffer& b = wanted.framebuffer;
    const auto is_adaptive = [](const Checkpoint& sums) { return sums.framebuffer.has_halves(); };
    if (a.width() != b.width() || a.height() != b.height() || a.fixed_point().limit != b.fixed_point().limit ||
        is_adaptive(found) != is_adaptive(wanted) || (!is_adaptive(found) && !found.sample_counts.empty()))
        throw InputError("its sums are not of the render that it says");
    if (a.fixed_point() != b.fixed_point())
        throw InputError(fmt::format(
            "its sums have a step for up to {:.0f} samples a pixel, and --spp {} needs that for {:.0f}: begin "
            "anew with as many as there shall be",
            most_samples(a.fixed_point()), wanted.spp, most_samples(b.fixed_point())));
}

std::int64_t Checkpoint::sample_count() const {
    std::int64_t count = 0;
    for (const SampleRange& range : ranges) count += range.end - range.first;
    return count;
}

std::vector<SampleRange> with_range(std::vector<SampleRange> ranges, const SampleRange& more) {
    for (const SampleRange& range : ranges)
        if (more.first < range.end && range.first < more.end)
            throw InputError(fmt::format("samples {} to {} are there already", std::max(more.first, range.first),
                                         std::min(more.end, range.end)));
    const auto at = std::lower_bound(ranges.begin(), ranges.end(), more,
                                     [](const SampleRange& a, const SampleRange& b) { return a.first < b.first; });
    ranges.insert(at, more);
    std::vector<SampleRange> joined;
    for (const SampleRange& range : ranges) {
        if (!joined.empty() && joined.back().end == range.first) {
            joined.back().end = range.end;
        } else {
            joined.push_back(range);
        }
    }
    return joined;
}

std::vector<SampleRange> gaps(const std::vector<SampleRange>& ranges, std::int64_t end) {
    std::vector<SampleRange> missing;
    std::int64_t next = 0;
    for (const SampleRange& range : ranges) {
        if (next < range.first) missing.push_back({next, range.first});
        next = range.end;
    }
    if (next < end) missing.push_back({next, end});
    return missing;
}

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& sums) {
    std::string text = json_text(header_of(sums), JsonLayout::OneLine) + "\n";
    append<std::int64_t>(text, sums.framebuffer.sums());
    append<std::int32_t>(text, sums.sample_counts);
    text += checksum(text);
    write_whole(path, std::as_bytes(std::span(text)));
}

Checkpoint decode_checkpoint(std::string_view content, const std::string& name) {
    const auto refuse = [&](std::string_view why) -> InputError {
        return InputError(fmt::format("{}: {}", name, why));
    };
    const std::size_t line = content.substr(0, kMostHeaderBytes).find('\n');
    json header;
    try {
        if (line != std::string_view::npos) header = parse_json(content.substr(0, line), name);
    } catch (const InputError&) {
        header = {};  // said below
    }
    if (!header.is_object() || header.value("format", json()) != kFormat)
        throw refuse("not a checkpoint or part of a render, or its beginning is damaged");
    const json version = header.value("version", json());
    if (!version.is_number_integer()) throw refuse("damaged: it has no version");
    if (version != kVersion)
        throw refuse(fmt::format("of version {}, this program reads version {}", version.dump(), kVersion));
    if (content.size() < line + 1 + kChecksumLength || checksum(content.substr(0, content.size() - kChecksumLength)) !=
                                                           content.substr(content.size() - kChecksumLength))
        throw refuse("damaged: its checksum is wrong");
    content.remove_suffix(kChecksumLength);
    try {
        return parsed(header, content.substr(line + 1));
    } catch (const json::exception& error) {
        throw refuse(error.what());
    } catch (const InputError& error) {
        throw refuse(error.what());
    }
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
    return decode_checkpoint(read_bytes(path), path.string());
}

}  // namespace raypool
