#include "cli/pool_options.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/runtime/settings_text.h"
#include "wavefront/setting_names.h"

namespace raypool::cli {

namespace {

using namespace wavefront;

/// Sets `value` to what `word` names; leaves it if that is nothing.
template <class Setting>
void set(Setting& value, const std::string& word) {
    value = parse_setting<Setting>(word).value_or(value);
}

}  // namespace

void add_pool_options(CLI::App& command, PoolOptions& options) {
    const auto add = [&]<class Setting>(const char* name, std::string& target, Setting, const char* what) {
        constexpr auto& kWords = SettingWords<Setting>::kWords;
        const std::vector<std::string> words(kWords.begin(), kWords.end());
        command.add_option(name, target, what)->check(CLI::IsMember(words))->group("Wavefront engine");
    };
    const PoolSettings defaults;
    add("--pool-scope", options.scope, defaults.scope, "One pool for all threads, or one for each (default: thread)");
    add("--refill", options.refill, defaults.refill, "Camera rays enter when the pool is empty, or when there is room");
    add("--stage-width", options.width, defaults.width, "Rays that a stage treats at a time (default: simd)");
    add("--intersect", options.intersection, defaults.intersection,
        "Ray by ray, as streams, or as streams of pairs of ray and sphere (default: pairs)");
    add("--camera", options.camera, defaults.camera,
        "Camera rays enter the pool at once, or after their first bounce, traced by registers or by beams (default: "
        "beam)");
    add("--sort", options.sort, defaults.sort, "Order of records before they are shaded (default: none)");
    add("--append", options.append, defaults.append, "How survivors of a shared pool reach the next round");
    add("--accumulator", options.accumulator, defaults.accumulator,
        "How radiance reaches the framebuffer (default: owned, of a shared pool atomic)");
    const auto count = CLI::Range(std::int64_t{1}, std::int64_t{std::numeric_limits<std::int32_t>::max()});
    command
        .add_option("--pool-rays", options.rays,
                    "Most records in a pool, or the bytes that they may take: 512KB, 2MB (default: by the bytes of the "
                    "trees; shared: 65536, or 16384 a thread)")
        ->check([](const std::string& text) {
            parse_pool_rays(text, 1);
            return std::string();
        })
        ->group("Wavefront engine");
    command
        .add_option(
            "--pool-batch", options.batch,
            "Records that a thread takes at a time from a shared pool (default: an eighth of its share, at most 4096)")
        ->check(count)
        ->group("Wavefront engine");
}

std::int64_t parse_pool_rays(std::string_view text, std::size_t record_bytes) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    constexpr std::pair<std::string_view, int> kUnits[] = {{"KB", 10}, {"MB", 20}, {"GB", 30}};
    std::string_view digits = text;
    int shift = 0;
    for (const auto& [unit, bits] : kUnits) {
        if (!text.ends_with(unit)) continue;
        digits.remove_suffix(unit.size());
        shift = bits;
    }
    const auto number = parse_integer(digits, 1, kMost);
    if (!number)
        throw InputError(fmt::format(
            "--pool-rays: must be a count of records in [1, {}], or their bytes as in 512KB, 2MB or 1GB, got {}", kMost,
            text));
    if (shift == 0) return *number;
    return std::clamp<std::int64_t>((*number << shift) / static_cast<std::int64_t>(record_bytes), 1, kMost);
}

PoolSettings pool_settings(const PoolOptions& options, std::size_t record_bytes, int threads) {
    PoolSettings settings;
    set(settings.scope, options.scope);
    if (settings.scope == PoolScope::Shared) {
        settings.accumulator = Accumulator::AtomicInt64;
        settings.capacity = shared_capacity(threads);
    }
    set(settings.refill, options.refill);
    set(settings.width, options.width);
    set(settings.intersection, options.intersection);
    set(settings.camera, options.camera);
    set(settings.sort, options.sort);
    set(settings.append, options.append);
    set(settings.accumulator, options.accumulator);
    if (!options.rays.empty()) settings.capacity = parse_pool_rays(options.rays, record_bytes);
    if (settings.scope == PoolScope::Shared)
        settings.batch =
            options.batch != 0 ? std::min(options.batch, settings.capacity) : shared_batch(settings.capacity, threads);
    if (settings.width == StageWidth::Scalar) {  // streams and beams are made of registers
        settings.intersection = Intersection::Single;
        if (settings.camera == CameraStage::Beam) settings.camera = CameraStage::Fused;
    }
    return settings;
}

nlohmann::json to_json(const PoolSettings& settings) {
    nlohmann::json result{{"scope", to_string(settings.scope)},
                          {"refill", to_string(settings.refill)},
                          {"stage_width", to_string(settings.width)},
                          {"intersect", to_string(settings.intersection)},
                          {"camera", to_string(settings.camera)},
                          {"sort", to_string(settings.sort)},
                          {"accumulator", to_string(settings.accumulator)},
                          {"rays", settings.capacity == PoolSettings::kAutomatic ? nlohmann::json("automatic")
                                                                                 : nlohmann::json(settings.capacity)}};
    if (settings.scope == PoolScope::Shared) {
        result["append"] = to_string(settings.append);
        result["batch"] = settings.batch;
        result["batch_schedule"] = to_string(settings.batch_schedule);
    }
    return result;
}

}  // namespace raypool::cli
