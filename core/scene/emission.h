/// How much light the shapes of a scene send out: what light sampling chooses lights by.
#pragma once

#include <vector>

#include "core/scene/scene.h"

namespace raypool {

/// Power in the unit of radiance times that of length squared, pi left out: area times mean radiance, for both sides of
/// a quad or triangle unless its front alone shines, and for the outside of a sphere. 0 of what is no emitter. The mean
/// is over a texture's cells or texels and over channels, and is taken once for each material.
class EmittedPower {
  public:
    /// The scene outlives it.
    explicit EmittedPower(const Scene& scene);

    [[nodiscard]] double of(const Sphere& sphere) const;
    [[nodiscard]] double of(const Quad& quad) const;
    /// Of a triangle of a mesh whose area is `area`.
    [[nodiscard]] double of(const MeshShape& mesh, double area) const;
    /// What the image of a background, if there is one, sends through the sphere around all shapes that have an end.
    [[nodiscard]] double of(const Background& background) const;

  private:
    [[nodiscard]] double of_flat(std::int32_t material_id, double area) const;

    const Scene& scene_;
    std::vector<double> mean_radiance_;  ///< by material
};

/// The solid angle of each texel in row `row` of an image all around.
double texel_solid_angle(const Image& image, std::int64_t row);

}  // namespace raypool
