/// Engines whose kernels are compiled for a set of features of choice, whatever the scene needs: study `features`.
///
/// The engines of the project are compiled for four sets (kCompiledFeatures); here are those with one feature each.
/// They make the image of any scene that lacks what they lack.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/studies/renders.h"
#include "core/scene/features.h"

namespace raypool::studies {

/// Fuzz is a property of metal, so no scene has it alone; and code that has it alone is the code that has nothing,
/// compiled again and put at another place. That is the control: what the place of the code makes of the time.
inline constexpr const char* kControl = "control";

struct FeatureSet {
    const char* name;
    Features features;
};
inline constexpr auto kFeatureSets = [] {
    std::array<FeatureSet, kFeatureNames.size() + 1> sets{};
    for (std::size_t i = 0; i < kFeatureNames.size(); ++i) {
        // Every member is written, the false ones too: g++ 12 leaves those that were not out of the symbols of the
        // templates, so that the functions of different sets get one name, and the linker keeps one of them.
        sets[i] = {kFeatureNames[i].name,
                   {i == 0, i == 1, i == 2 || i == 3, i == 3, i == 4 || i == 5, i == 5, i == 6, i == 7, i == 8, i == 9,
                    i == 10, i == 11}};
    }
    sets.back() = {kControl, {.fuzz = true}};
    return sets;
}();

/// What Engine::begin() is.
using BeginFunction = std::unique_ptr<RenderSession> (*)(const CompiledScene<float>&, const RenderSettings&,
                                                         Framebuffer&);

/// By kFeatureSets.
BeginFunction iterative_begin(std::size_t set);
BeginFunction pool_begin(std::size_t set);

/// They compile slowly, so they are compiled in three parts of so many sets (feature_engines.cpp).
inline constexpr std::size_t kPartSets = 5;
static_assert(3 * kPartSets >= kFeatureSets.size());
struct FeatureFunctions {
    BeginFunction iterative, pool;
};
template <std::size_t part>
std::vector<FeatureFunctions> functions_of_part();
template <>
std::vector<FeatureFunctions> functions_of_part<0>();
template <>
std::vector<FeatureFunctions> functions_of_part<1>();
template <>
std::vector<FeatureFunctions> functions_of_part<2>();

}  // namespace raypool::studies
