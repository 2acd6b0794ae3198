/// Scenes for tests of shapes that coincide: a sky, and places in any position.
#pragma once

#include "tests/physics/test_scene.h"
#include "tests/random_inputs.h"

namespace raypool::test {

/// A sky that is 0 below and 1 above.
inline TestScene under_a_sky() {
    TestScene scene(24, 16, Vector3d::Ones());
    scene.background.bottom = Vector3d::Zero();
    scene.camera.shutter_close = 1;
    scene.look({0.3, 2.1, 5.7}, {0, 0, 0}, 20);
    return scene;
}

inline Quad quad_of(const Vector3d& corner, const Vector3d& u, const Vector3d& v, std::int32_t material = 0) {
    return {corner, u, v, material};
}

struct Frame {
    Vector3d at, u, v, n;
};
inline Frame random_frame(RandomInputs& random, double reach) {
    const Vector3d n = random.direction<double>();
    const Vector3d aside = random.direction<double>();
    const Vector3d u = (aside - aside.dot(n) * n).normalized();
    return {reach * random.point<double>(1), u, n.cross(u), n};
}

}  // namespace raypool::test
