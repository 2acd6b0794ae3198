#include "core/settings_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"

namespace raypool {

namespace {

constexpr std::string_view kScheduleNames[] = {"static", "dynamic", "guided"};

}  // namespace

std::optional<std::int64_t> parse_integer(std::string_view text, std::int64_t least, std::int64_t most) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < least || value > most) return std::nullopt;
    return value;
}

LoopSchedule parse_schedule(std::string_view text, std::string_view source) {
    const std::size_t comma = text.find(',');
    const std::string_view name = text.substr(0, comma);
    for (int i = 0; i < 3; ++i) {
        if (name != kScheduleNames[i]) continue;
        LoopSchedule schedule{static_cast<LoopSchedule::Kind>(i), 0};
        if (comma == std::string_view::npos) return schedule;
        const auto chunk = parse_integer(text.substr(comma + 1), 1, std::numeric_limits<int>::max());
        if (chunk) {
            schedule.chunk = static_cast<int>(*chunk);
            return schedule;
        }
    }
    throw InputError(fmt::format(
        "{}: must be static, dynamic or guided, with an optional chunk >= 1 as in dynamic,4, got {}", source, text));
}

std::string to_string(const LoopSchedule& schedule) {
    const std::string_view name = kScheduleNames[static_cast<int>(schedule.kind)];
    return schedule.chunk == 0 ? std::string(name) : fmt::format("{},{}", name, schedule.chunk);
}

Grain parse_grain(std::string_view text) {
    if (text == "pixel") return {Grain::Kind::Pixel, 1};
    if (text == "line") return {Grain::Kind::Line, 1};
    if (text.starts_with("tile:")) {
        if (const auto edge = parse_integer(text.substr(5), 1, 65536))
            return {Grain::Kind::Tile, static_cast<int>(*edge)};
    }
    throw InputError(fmt::format("--grain: must be pixel, line or tile:N with N in [1, 65536], got {}", text));
}

std::string to_string(const Grain& grain) {
    switch (grain.kind) {
        case Grain::Kind::Pixel:
            return "pixel";
        case Grain::Kind::Line:
            return "line";
        case Grain::Kind::Tile:
            break;
    }
    return fmt::format("tile:{}", grain.tile);
}

Sampler parse_sampler(std::string_view text) {
    if (text == "independent") return Sampler::Independent;
    if (text == "sobol") return Sampler::Sobol;
    throw InputError(fmt::format("--sampler: must be independent or sobol, got {}", text));
}

std::string to_string(Sampler sampler) {
    return sampler == Sampler::Sobol ? "sobol" : "independent";
}

LoopSchedule default_schedule() {
    const char* said = std::getenv("OMP_SCHEDULE");
    if (said == nullptr) return {LoopSchedule::Kind::Dynamic, 0};
    std::string text;
    for (const char c : std::string_view(said))
        if (c != ' ' && c != '\t') text += 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return parse_schedule(text, "OMP_SCHEDULE");
}

void set_width(Scene& scene, std::int64_t width) {
    constexpr std::int64_t kMostSide = 65536;
    const double shape = static_cast<double>(scene.height) / static_cast<double>(scene.width);
    const std::int64_t height = std::max<std::int64_t>(1, std::llround(static_cast<double>(width) * shape));
    if (width < 1 || width > kMostSide || height > kMostSide)
        throw InputError(
            fmt::format("--width: must give an image of 1 to {} pixels on either side, got {}", kMostSide, width));
    scene.width = width;
    scene.height = height;
}

}  // namespace raypool
