/// The scene that the benchmarks work on, `paper`, and the number types that the engines compile for it.
#pragma once

#include "core/compiled_scene.h"
#include "core/error.h"
#include "core/scene_reader.h"

namespace raypool {

inline constexpr SceneNeeds kPaper = kCompiledNeeds[1];
/// A register of rays.
using Lanes = Wide<float, stdx::native_simd<float>::size()>;

inline const CompiledScene<float>& paper_scene() {
    static const CompiledScene<float> scene = [] {
        CompiledScene<float> compiled = compile<float>(builtin_scene("paper"));
        RAYPOOL_CHECK(kCompiledNeeds[compiled_needs_index(compiled.needs)] == kPaper, "the engines run other code");
        return compiled;
    }();
    return scene;
}

}  // namespace raypool
