/// A scene without any feature of Features, but with the shapes and so nearly the work of another: study `features`.
#pragma once

#include "core/scene/scene.h"

namespace raypool::studies {

/// The spheres of `scene` standing still, all of them diffuse, before a pinhole camera. Solid colours stay; a checker
/// keeps its even colour, and what has none or shines becomes grey. Throws InputError for a scene without spheres.
Scene plain_scene(const Scene& scene);

}  // namespace raypool::studies
