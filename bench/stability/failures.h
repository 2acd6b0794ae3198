/// Pictures of failure: scenes on which one naive method ruins the image, rendered with it and with ours.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/runtime/engine.h"
#include "core/scene/scene.h"

namespace raypool::stability {

/// One naive method in the place of ours.
enum class NaiveVariant : std::uint8_t {
    LeastDistance,   ///< a hit closer than 1e-3 does not count, and a ray does not know what it leaves
    HalfB,           ///< the quadratic of the books
    Truncation,      ///< checkers by rounding towards zero
    IdAlone,         ///< methods are ours, but no shapes are held to coincide: a ray leaves one shape, by its id
    WholeShadowRay,  ///< what a shadow ray meets closer than the light hides it, the light itself too
    ShortShadowRay,  ///< a shadow ray ends at 1 - 1e-4 of its way
    NoSine           ///< an image's density of directions is one over the square, without the sine of the angle
};

/// Adds the settings' samples, of independent numbers, in single precision, one path after the other.
void render_naively(NaiveVariant variant, const Scene& scene, const RenderSettings& settings, Framebuffer& framebuffer);

struct Failure {
    std::string id;  ///< the picture's name; scripts/analysis/stability.py says what to see
    std::string row;
    NaiveVariant variant;
    Scene scene;
};
/// The entries of failures.json, whose scenes are written as docs/scene-format.md says. Instead of the background there
/// may be a "sky": a grey image with a sun in one texel.
const std::vector<Failure>& all_failures();

/// One scene three times: by the naive method, by the engine in float, and by the engine in double. Lights, if there
/// are any, are found by light sampling alone.
struct FailureImages {
    Image naive, ours, reference;
};
FailureImages render_failure(NaiveVariant variant, const Scene& scene, RenderSettings settings);

/// Part of the pixels with a channel off by more than 0.02.
double changed_share(const Image& image, const Image& reference);

}  // namespace raypool::stability
