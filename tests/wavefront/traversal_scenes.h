/// Scenes that make walks through trees go wrong, if anything does: none and one shape, twins, all kinds, motion.
#pragma once

#include <Eigen/Geometry>

#include "core/scene/scene.h"
#include "tests/meshes.h"
#include "tests/random_inputs.h"

namespace raypool::wavefront {

inline Scene empty_scene() {
    Scene scene;
    scene.textures.emplace_back();
    scene.materials.emplace_back();
    scene.camera.shutter_close = 1;
    return scene;
}
inline Scene one_sphere() {
    Scene scene = empty_scene();
    scene.spheres.push_back({{1, 2, 3}, {1, 2, 3}, 2, 0});
    return scene;
}
inline Scene still_spheres() {
    test::RandomInputs random(1);
    Scene scene = empty_scene();
    for (int i = 0; i < 300; ++i) {
        const Vector3d center = i % 3 == 0 ? random.lattice_point<double>(5) : random.point<double>(6);
        scene.spheres.push_back({center, center, i % 3 == 0 ? 0.5 : random.uniform(0.05, 1), 0});
    }
    return scene;
}
inline Scene moving_spheres() {
    test::RandomInputs random(2);
    Scene scene = still_spheres();
    for (Sphere& sphere : scene.spheres)
        if (!random.one_in(3)) sphere.center1 += random.point<double>(2);
    return scene;
}
/// Every sphere and quad several times over, near each other in some trees and far in others.
inline Scene twins() {
    test::RandomInputs random(3);
    Scene scene = still_spheres();
    scene.spheres.resize(60);
    for (std::size_t i = 0; i < 180; ++i) scene.spheres.push_back(scene.spheres[59 - i % 60]);
    for (std::size_t i = 0; i < 20; ++i)
        scene.quads.push_back({random.lattice_point<double>(5), {2, 0, 0}, {0, 1, 1}, 0});
    for (std::size_t i = 0; i < 40; ++i) scene.quads.push_back(scene.quads[19 - i % 20]);
    return scene;
}
inline Scene all_shapes() {
    test::RandomInputs random(4);
    Scene scene = moving_spheres();
    for (int i = 0; i < 100; ++i) {
        const Vector3d corner = i % 2 == 0 ? random.point<double>(6) : random.lattice_point<double>(5);
        const Vector3d u = i % 2 == 0 ? random.direction<double>() : Vector3d(2, 0, 0);
        scene.quads.push_back({corner, u, i % 2 == 0 ? Vector3d(u.unitOrthogonal()) : Vector3d(0, 1, 0), 0});
    }
    for (int i = 0; i < 9; ++i) {
        const Vector3d point = 12 * random.direction<double>();
        scene.planes.push_back({point, point, 0});
    }
    scene.spheres.push_back({{0, -1006, 0}, {0, -1006, 0}, 1000, 0});  // large: outside the tree
    return scene;
}

inline Scene meshes() {
    test::RandomInputs random(5);
    Scene scene = moving_spheres();
    scene.spheres.resize(30);
    for (const auto& mesh : {test::icosphere(2), test::triangle_soup(300, random)})
        scene.meshes.push_back({std::make_shared<const Mesh>(mesh)});
    return scene;
}

/// Turned, stretched, mirrored, one within another, and some twice; beside a mesh that is no instance.
inline Scene instances() {
    test::RandomInputs random(6);
    Scene scene = meshes();
    scene.meshes.resize(1);
    const std::shared_ptr<const Mesh> objects[] = {std::make_shared<const Mesh>(test::icosphere(1)),
                                                   std::make_shared<const Mesh>(test::triangle_soup(30, random))};
    for (int i = 0; i < 30; ++i) {
        MeshShape shape{objects[i % 2]};
        shape.is_instance = true;
        Eigen::Affine3d place(
            Eigen::Translation3d(i % 3 == 0 ? random.lattice_point<double>(5) : random.point<double>(5)));
        if (i % 3 != 0) place = place * Eigen::AngleAxisd(random.uniform(0, 6), random.direction<double>());
        Vector3d scale = Vector3d::Constant(std::exp2(random.below(4) - 3));
        if (i % 4 == 1) scale = {random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(-1, -0.1)};
        shape.transform = (place * Eigen::Scaling(scale)).affine();
        scene.meshes.push_back(shape);
        if (i % 5 == 0) scene.meshes.push_back(shape);
    }
    return scene;
}

struct TestScene {
    const char* name;
    Scene (*make)();
};
inline constexpr TestScene kScenes[] = {{"empty_scene", empty_scene},
                                        {"one_sphere", one_sphere},
                                        {"still_spheres", still_spheres},
                                        {"moving_spheres", moving_spheres},
                                        {"twins", twins},
                                        {"all_shapes", all_shapes},
                                        {"meshes", meshes},
                                        {"instances", instances}};

}  // namespace raypool::wavefront
