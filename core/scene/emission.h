/// How much light the shapes of a scene send out: what light sampling chooses lights by.
#pragma once

#include "core/scene/scene.h"

namespace raypool {

/// The mean of the texture's radiance over its cells or texels, times the strength, averaged over the channels; 0 of
/// what is no emitter.
double mean_radiance(const Scene& scene, const Material& material);

/// Power in the unit of radiance times that of length squared, pi left out: area times mean radiance, for both sides
/// of a quad unless its front alone shines, and for the outside of a sphere.
double emitted_power(const Scene& scene, const Sphere& sphere);
double emitted_power(const Scene& scene, const Quad& quad);

}  // namespace raypool
