#include "core/shading/camera.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace raypool {

namespace {
double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}
}  // namespace

template <class Scalar>
Camera<Scalar> make_camera(const CameraDescription& description, std::int64_t width, std::int64_t height) {
    const bool has_lens = description.defocus_angle_degrees > 0;
    const double focus_distance = has_lens ? description.focus_distance : 1;
    const double view_height = 2 * std::tan(radians(description.vertical_fov_degrees) / 2) * focus_distance;
    const double pixel_size = view_height / static_cast<double>(height);

    const Vector3d backward = (description.look_from - description.look_at).normalized();
    const Vector3d right = description.up.cross(backward).normalized();
    const Vector3d upward = backward.cross(right);
    const double lens_radius = has_lens ? focus_distance * std::tan(radians(description.defocus_angle_degrees) / 2) : 0;

    const auto cast = [](const Vector3d& v) { return Vec3<Scalar>(v.cast<Scalar>()); };
    Camera<Scalar> camera;
    camera.origin = cast(description.look_from);
    camera.to_center = cast(-focus_distance * backward);
    camera.pixel_u = cast(pixel_size * right);
    camera.pixel_v = cast(-pixel_size * upward);
    camera.lens_u = cast(lens_radius * right);
    camera.lens_v = cast(lens_radius * upward);
    camera.half_width = static_cast<Scalar>(static_cast<double>(width) / 2);
    camera.half_height = static_cast<Scalar>(static_cast<double>(height) / 2);
    camera.shutter_open = static_cast<Scalar>(description.shutter_open);
    camera.shutter_length = static_cast<Scalar>(description.shutter_close - description.shutter_open);
    return camera;
}

template Camera<float> make_camera(const CameraDescription&, std::int64_t, std::int64_t);
template Camera<double> make_camera(const CameraDescription&, std::int64_t, std::int64_t);

}  // namespace raypool
