#include "cli/pool_options.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace raypool::cli {

namespace {

using namespace wavefront;

/// The words of a setting, in the order of its enumerators.
using Words = std::vector<std::string>;
const Words kScope{"shared", "thread"};
const Words kRefill{"drain", "regenerate"};
const Words kWidth{"scalar", "simd"};
const Words kIntersection{"single", "stream"};
const Words kCamera{"staged", "fused"};
const Words kSort{"none", "material"};
const Words kAppend{"in-place", "atomic", "prefix-sum"};
const Words kAccumulator{"owned",         "atomic",       "private",      "owned-planar",
                         "atomic-planar", "atomic-float", "atomic-double"};

/// Sets `value` to the enumerator that `word` names, if it names one.
template <class Enum>
void set(Enum& value, const Words& words, const std::string& word) {
    const auto found = std::find(words.begin(), words.end(), word);
    if (found != words.end()) value = static_cast<Enum>(std::distance(words.begin(), found));
}

template <class Enum>
const std::string& word(const Words& words, Enum value) {
    return words[static_cast<std::size_t>(value)];
}

}  // namespace

void add_pool_options(CLI::App& command, PoolOptions& options) {
    const auto add = [&](const char* name, std::string& target, const Words& words, const char* what) {
        command.add_option(name, target, what)->check(CLI::IsMember(words))->group("Wavefront engine");
    };
    add("--pool-scope", options.scope, kScope, "One pool for all threads, or one for each (default: thread)");
    add("--refill", options.refill, kRefill, "Camera rays enter when the pool is empty, or when there is room");
    add("--stage-width", options.width, kWidth, "Rays that a stage treats at a time (default: simd)");
    add("--intersect", options.intersection, kIntersection, "Ray by ray, or as streams (default: stream)");
    add("--camera", options.camera, kCamera, "Camera rays enter the pool at once, or after their first bounce");
    add("--sort", options.sort, kSort, "Order of records before they are shaded (default: none)");
    add("--append", options.append, kAppend, "How survivors of a shared pool reach the next round");
    add("--accumulator", options.accumulator, kAccumulator,
        "How radiance reaches the framebuffer (default: owned, of a shared pool atomic)");
    const auto count = CLI::Range(std::int64_t{1}, std::int64_t{std::numeric_limits<std::int32_t>::max()});
    command
        .add_option("--pool-rays", options.rays, "Most records in a pool, or the bytes that they may take: 512KB, 2MB")
        ->check([](const std::string& text) {
            parse_pool_rays(text, 1);
            return std::string();
        })
        ->group("Wavefront engine");
    command.add_option("--pool-batch", options.batch, "Records that a thread takes at a time from a shared pool")
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
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size() || number < 1 || number > kMost)
        throw InputError(fmt::format(
            "--pool-rays: must be a count of records in [1, {}], or their bytes as in 512KB, 2MB or 1GB, got {}", kMost,
            text));
    if (shift == 0) return number;
    return std::clamp<std::int64_t>((number << shift) / static_cast<std::int64_t>(record_bytes), 1, kMost);
}

PoolSettings pool_settings(const PoolOptions& options, std::size_t record_bytes) {
    PoolSettings settings;
    set(settings.scope, kScope, options.scope);
    if (settings.scope == PoolScope::Shared) {
        settings.accumulator = Accumulator::AtomicInt64;
        settings.capacity = PoolSettings::kSharedCapacity;
    }
    set(settings.refill, kRefill, options.refill);
    set(settings.width, kWidth, options.width);
    set(settings.intersection, kIntersection, options.intersection);
    set(settings.camera, kCamera, options.camera);
    set(settings.sort, kSort, options.sort);
    set(settings.append, kAppend, options.append);
    set(settings.accumulator, kAccumulator, options.accumulator);
    if (!options.rays.empty()) settings.capacity = parse_pool_rays(options.rays, record_bytes);
    if (options.batch != 0) settings.batch = options.batch;
    return settings;
}

nlohmann::json to_json(const PoolSettings& settings) {
    return {{"scope", word(kScope, settings.scope)},
            {"refill", word(kRefill, settings.refill)},
            {"stage_width", word(kWidth, settings.width)},
            {"intersect", word(kIntersection, settings.intersection)},
            {"camera", word(kCamera, settings.camera)},
            {"sort", word(kSort, settings.sort)},
            {"append", word(kAppend, settings.append)},
            {"accumulator", word(kAccumulator, settings.accumulator)},
            {"rays", settings.capacity},
            {"batch", settings.batch}};
}

}  // namespace raypool::cli
