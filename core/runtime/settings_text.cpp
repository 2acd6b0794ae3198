#include "core/runtime/settings_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool {

std::optional<std::int64_t> parse_integer(std::string_view text, std::int64_t least, std::int64_t most) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < least || value > most) return std::nullopt;
    return value;
}

namespace {

constexpr std::string_view kScheduleNames[] = {"static", "dynamic", "guided", "tasks", "balanced"};

/// Of these kinds, with a chunk where the kind may have one.
std::optional<LoopSchedule> read_schedule(std::string_view text, std::initializer_list<LoopSchedule::Kind> kinds) {
    using Kind = LoopSchedule::Kind;
    const std::size_t comma = text.find(',');
    const std::string_view name = text.substr(0, comma);
    for (const Kind kind : kinds) {
        if (name != kScheduleNames[static_cast<int>(kind)]) continue;
        LoopSchedule schedule{kind, 0};
        if (comma == std::string_view::npos) return schedule;
        if (kind == Kind::Balanced) break;
        const auto chunk = parse_integer(text.substr(comma + 1), 1, std::numeric_limits<int>::max());
        if (chunk) {
            schedule.chunk = static_cast<int>(*chunk);
            return schedule;
        }
    }
    return std::nullopt;
}

}  // namespace

LoopSchedule parse_schedule(std::string_view text) {
    using Kind = LoopSchedule::Kind;
    const auto schedule = read_schedule(text, {Kind::Static, Kind::Dynamic, Kind::Guided, Kind::Tasks, Kind::Balanced});
    if (schedule) return *schedule;
    throw InputError(
        fmt::format("--schedule: must be balanced, or static, dynamic, guided or tasks with an optional chunk >= 1 as "
                    "in dynamic,4, got {}",
                    text));
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

LightSampling parse_light_sampling(std::string_view text) {
    if (text == "none") return LightSampling::None;
    if (text == "light") return LightSampling::Light;
    if (text == "mis") return LightSampling::Mis;
    throw InputError(fmt::format("--light-sampling: must be none, light or mis, got \"{}\"", text));
}

std::string to_string(LightSampling sampling) {
    return sampling == LightSampling::None ? "none" : sampling == LightSampling::Light ? "light" : "mis";
}

std::optional<LoopSchedule> schedule_of_environment() {
    const char* said = std::getenv("OMP_SCHEDULE");
    if (said == nullptr) return std::nullopt;
    std::string text;
    for (const char c : std::string_view(said))
        if (c != ' ' && c != '\t') text += 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    using Kind = LoopSchedule::Kind;
    const auto schedule = read_schedule(text, {Kind::Static, Kind::Dynamic, Kind::Guided});
    if (schedule) return *schedule;
    throw InputError(fmt::format(
        "OMP_SCHEDULE: must be static, dynamic or guided, with an optional chunk >= 1 as in dynamic,4, got {}", text));
}

LoopSchedule chosen_schedule(const std::optional<std::string>& schedule, const std::optional<std::string>& grain) {
    if (schedule) return parse_schedule(*schedule);
    if (const auto said = schedule_of_environment()) return *said;
    return {grain ? LoopSchedule::Kind::Dynamic : LoopSchedule::Kind::Balanced, 0};
}

void set_width(Scene& scene, std::int64_t width) {
    set_size(scene, width, 0);
}

void set_size(Scene& scene, std::int64_t width, std::int64_t height) {
    constexpr std::int64_t kMostSide = 65536;
    const auto scaled = [](std::int64_t side, std::int64_t to, std::int64_t from) {
        const double shape = static_cast<double>(to) / static_cast<double>(from);
        return std::max<std::int64_t>(1, std::llround(static_cast<double>(side) * shape));
    };
    if (width == 0 && height == 0) return;
    const char* option = width == 0 ? "--height" : "--width";
    const std::int64_t asked = width == 0 ? height : width;
    if (width == 0) width = scaled(height, scene.width, scene.height);
    if (height == 0) height = scaled(width, scene.height, scene.width);
    for (const std::int64_t side : {width, height})
        if (side < 1 || side > kMostSide)
            throw InputError(fmt::format("{}: must give an image of 1 to {} pixels on either side, got {}", option,
                                         kMostSide, asked));
    scene.width = width;
    scene.height = height;
}

}  // namespace raypool
