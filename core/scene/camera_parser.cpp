#include "core/scene/camera_parser.h"

#include "core/scene/lengths.h"

namespace raypool {

namespace {

// Beyond these angles a tangent of half of them times kMaxLength could leave float.
constexpr double kMinFovDegrees = 0.001;
constexpr double kMaxAngleDegrees = 179.9;

}  // namespace

CameraDescription parse_camera(JsonObject object) {
    CameraDescription camera;
    camera.look_from = position(object.required("look_from"));
    const JsonCursor look_at = object.required("look_at");
    camera.look_at = position(look_at);
    const Vector3d view = camera.look_at - camera.look_from;
    if (view.norm() < kMinLength) look_at.refuse("differ from look_from", "the same point");

    if (const auto up = object.optional("up")) camera.up = direction(*up);
    if (are_parallel(camera.up, view)) {
        object.place().refuse("have an up that is not parallel to the line from look_from to look_at",
                              fmt::format("up [{:g}, {:g}, {:g}]", camera.up.x(), camera.up.y(), camera.up.z()));
    }

    if (const auto fov = object.optional("vertical_fov_degrees")) {
        camera.vertical_fov_degrees = fov->number(kMinFovDegrees, kMaxAngleDegrees);
    }
    if (const auto angle = object.optional("defocus_angle_degrees")) {
        camera.defocus_angle_degrees = angle->number(0, kMaxAngleDegrees);
    }
    if (const auto distance = object.optional("focus_distance")) {
        camera.focus_distance = distance->number(kMinLength, kMaxLength);
    } else if (camera.defocus_angle_degrees > 0) {
        object.place().refuse("have the key \"focus_distance\" when defocus_angle_degrees is above 0", "none");
    }

    if (const auto shutter = object.optional("shutter")) {
        if (shutter->size() != 2) shutter->refuse("be an array of 2 numbers: open, close");
        camera.shutter_open = shutter->item(0).number(0, 1);
        camera.shutter_close = shutter->item(1).number(0, 1);
        if (camera.shutter_close < camera.shutter_open) {
            shutter->refuse("open before it closes",
                            fmt::format("[{:g}, {:g}]", camera.shutter_open, camera.shutter_close));
        }
    }
    object.refuse_unknown_keys();
    return camera;
}

}  // namespace raypool
