/// The camera's tables and the kernel that makes camera rays.
///
/// Thin lens after "Ray Tracing in One Weekend" (chapters 12 and 13). A ray's film point is kept as the pixel's offset
/// from the image centre, exact, and the jitter within the pixel, so that a large image loses no jitter.
#pragma once

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/scene/features.h"

namespace raypool {

template <class Scalar>
struct Camera {
    Vec3<Scalar> origin;
    Vec3<Scalar> to_center;  ///< from the origin to the centre of the image on the plane of focus
    Vec3<Scalar> pixel_u;    ///< one pixel to the right on the plane of focus
    Vec3<Scalar> pixel_v;    ///< one pixel down
    Vec3<Scalar> lens_u;     ///< radii of the lens; zero for a pinhole
    Vec3<Scalar> lens_v;
    Scalar half_width;  ///< of the image, in pixels
    Scalar half_height;
    Scalar shutter_open;
    Scalar shutter_length;
};

template <class Scalar>
Camera<Scalar> make_camera(const CameraDescription& description, std::int64_t width, std::int64_t height);

extern template Camera<float> make_camera(const CameraDescription&, std::int64_t, std::int64_t);
extern template Camera<double> make_camera(const CameraDescription&, std::int64_t, std::int64_t);

/// Camera rays through pixels (x, y), x to the right from 0, y down from 0, both whole; `pixel` is y * width + x.
template <Features features, class Real>
RAYPOOL_INLINE Ray<Real> camera_ray(const Camera<ScalarOf<Real>>& camera, const Real& x, const Real& y,
                                    const Uint32<Real>& pixel, const Uint32<Real>& sample, const RandomSeed& seed) {
    using U = Uint32<Real>;
    const std::array<Real, 4> film = random_block<Real>({pixel, sample}, U(0U), RandomPurpose::Film, seed);

    Ray<Real> ray;
    const Real column = x - Real(camera.half_width);
    const Real row = y - Real(camera.half_height);
    Vec3<Real> toward;
    for (int i = 0; i < 3; ++i) {
        const Real pixel_corner = mad<Real>(column, Real(camera.pixel_u[i]),
                                            mad<Real>(row, Real(camera.pixel_v[i]), Real(camera.to_center[i])));
        toward[i] =
            mad<Real>(film[0], Real(camera.pixel_u[i]), mad<Real>(film[1], Real(camera.pixel_v[i]), pixel_corner));
    }
    ray.origin = broadcast<Real>(camera.origin);
    if constexpr (features.defocus) {
        const std::array<Real, 2> lens = unit_disc<Real>(film[2], film[3]);
        for (int i = 0; i < 3; ++i) {
            const Real shift = mad<Real>(lens[0], Real(camera.lens_u[i]), lens[1] * Real(camera.lens_v[i]));
            ray.origin[i] = ray.origin[i] + shift;
            toward[i] = toward[i] - shift;
        }
    }
    ray.direction = unit<Real>(toward);

    ray.time = Real(0);
    if constexpr (features.motion) {
        const std::array<Real, 4> shutter = random_block<Real>({pixel, sample}, U(0U), RandomPurpose::Shutter, seed);
        ray.time = mad<Real>(shutter[0], Real(camera.shutter_length), Real(camera.shutter_open));
    }
    return ray;
}

}  // namespace raypool
