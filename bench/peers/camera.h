/// The peer's camera: a thin lens with a shutter, for one ray or for a packet.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "bench/peers/numbers.h"

namespace raypool::peers {

template <class F>
struct CameraRay {
    V3<F> origin, direction;
    F time;
};

class PeerCamera {
  public:
    explicit PeerCamera(const Scene& scene) {
        const CameraDescription& camera = scene.camera;
        const double half_degree = std::numbers::pi / 360;
        const bool has_lens = camera.defocus_angle_degrees > 0;
        const double distance = has_lens ? camera.focus_distance : 1;
        const Vector3d forward = (camera.look_at - camera.look_from).normalized();
        const Vector3d right = forward.cross(camera.up).normalized();
        const Vector3d down = forward.cross(right);
        const double pixel =
            2 * distance * std::tan(camera.vertical_fov_degrees * half_degree) / static_cast<double>(scene.height);
        const double lens = has_lens ? distance * std::tan(camera.defocus_angle_degrees * half_degree) : 0;
        eye_ = to_v3(camera.look_from);
        corner_ = to_v3(distance * forward - pixel * (static_cast<double>(scene.width) / 2 * right +
                                                      static_cast<double>(scene.height) / 2 * down));
        step_x_ = to_v3(pixel * right);
        step_y_ = to_v3(pixel * down);
        lens_x_ = to_v3(lens * right);
        lens_y_ = to_v3(lens * down);
        open_ = static_cast<float>(camera.shutter_open);
        open_for_ = static_cast<float>(camera.shutter_close - camera.shutter_open);
    }

    /// Through a random point of the pixel in this column and row (counted from the top) and of the lens.
    template <class F>
    RAYPOOL_PEER_INLINE CameraRay<F> ray(F pixel_column, F pixel_row, Xoshiro<F>& random) const {
        const F x = pixel_column + random.next();
        const F y = pixel_row + random.next();
        const F radius = root(random.next());
        const Circle<F> circle = on_circle(random.next());
        const V3<F> shift =
            (radius * circle.cos) * all_lanes<F>(lens_x_) + (radius * circle.sin) * all_lanes<F>(lens_y_);
        const V3<F> toward = all_lanes<F>(corner_) + x * all_lanes<F>(step_x_) + y * all_lanes<F>(step_y_) - shift;
        const F time = open_ + random.next() * open_for_;
        return {all_lanes<F>(eye_) + shift, (1.0F / root(dot(toward, toward))) * toward, time};
    }

  private:
    V3<float> eye_, corner_, step_x_, step_y_, lens_x_, lens_y_;
    float open_, open_for_;
};

}  // namespace raypool::peers
