/// The pool's settings as the words that users write and tables show: one table for the command and the studies.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>

#include "wavefront/settings.h"

namespace raypool::wavefront {

/// The words of a setting, in the order of its enumerators.
template <class Setting>
struct SettingWords;
template <>
struct SettingWords<PoolScope> {
    static constexpr std::array kWords{"shared", "thread"};
};
template <>
struct SettingWords<Refill> {
    static constexpr std::array kWords{"drain", "regenerate"};
};
template <>
struct SettingWords<StageWidth> {
    static constexpr std::array kWords{"scalar", "simd"};
};
template <>
struct SettingWords<Intersection> {
    static constexpr std::array kWords{"single", "stream", "pairs"};
};
template <>
struct SettingWords<CameraStage> {
    static constexpr std::array kWords{"staged", "fused", "beam"};
};
template <>
struct SettingWords<Sort> {
    static constexpr std::array kWords{"none", "material"};
};
template <>
struct SettingWords<Append> {
    static constexpr std::array kWords{"in-place", "atomic", "prefix-sum"};
};
template <>
struct SettingWords<Accumulator> {
    static constexpr std::array kWords{"owned",         "atomic",       "private",      "owned-planar",
                                       "atomic-planar", "atomic-float", "atomic-double"};
};

template <class Setting>
concept HasWords = requires {
    SettingWords<Setting>::kWords;
};

template <HasWords Setting>
constexpr const char* to_string(Setting setting) {
    return SettingWords<Setting>::kWords[static_cast<std::size_t>(setting)];
}

/// The setting that a word names, if it names one.
template <HasWords Setting>
constexpr std::optional<Setting> parse_setting(std::string_view word) {
    constexpr auto& words = SettingWords<Setting>::kWords;
    const auto found = std::find(words.begin(), words.end(), word);
    if (found == words.end()) return std::nullopt;
    return static_cast<Setting>(std::distance(words.begin(), found));
}

}  // namespace raypool::wavefront
