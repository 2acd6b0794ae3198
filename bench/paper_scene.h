/// The scene that the benchmarks work on, `paper`, and the types that the engines compile for it.
#pragma once

#include "core/base/error.h"
#include "core/scene/scene_reader.h"
#include "core/shading/compiled_scene.h"
#include "wavefront/ray_columns.h"

namespace raypool {

inline constexpr Features kPaper = kCompiledFeatures[1];
/// A register of rays.
using Lanes = Wide<float, stdx::native_simd<float>::size()>;
using Records = wavefront::RayColumns<kPaper, float>;

inline const CompiledScene<float>& paper_scene() {
    static const CompiledScene<float> scene = [] {
        CompiledScene<float> compiled = compile<float>(builtin_scene("paper"));
        RAYPOOL_CHECK(kCompiledFeatures[compiled_features_index(compiled.features)] == kPaper,
                      "the engines run other code");
        return compiled;
    }();
    return scene;
}

}  // namespace raypool
