/// Spheres as compile() puts them into its trees: with their padded radius, and with the box of the leaf they are in.
#pragma once

#include <bit>
#include <vector>

#include "core/compiled_scene.h"

namespace raypool::stability {

template <class Scalar>
struct PaddedSphere {
    Vec3<Scalar> center;
    Vec3<Scalar> motion;
    Scalar radius;
    Scalar padded_radius;
    Vec3<Scalar> leaf_low, leaf_high;  ///< without a leaf, of a sphere that is set aside as large, infinite
};

/// In the order in which they are given.
template <class Scalar>
std::vector<PaddedSphere<Scalar>> padded_spheres(const std::vector<Sphere>& spheres) {
    Scene scene;
    scene.textures.emplace_back();
    scene.materials.emplace_back();
    scene.spheres = spheres;
    for (Sphere& sphere : scene.spheres) sphere.material_id = 0;
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);

    std::vector<PaddedSphere<Scalar>> padded(spheres.size());
    const auto take = [&](const auto& block, const Vec3<Scalar>& low, const Vec3<Scalar>& high) {
        for (int lane = 0; lane < block.kLanes; ++lane) {
            if (block.id[lane] == kNoPrimitive) continue;
            const auto part = [&](const auto& column) {
                return vec3<Scalar>(column[0][lane], column[1][lane], column[2][lane]);
            };
            padded[static_cast<std::size_t>(block.id[lane])] = {
                part(block.center), part(block.motion), block.radius[lane], block.padded_radius[lane], low, high};
        }
    };
    const Vec3<Scalar> far = Vec3<Scalar>::Constant(kInfinity<Scalar>);
    for (const auto& block : compiled.large_spheres) take(block, -far, far);
    for (const auto& node : compiled.sphere_tree.nodes)
        for (int lane = 0; lane < kTreeWidth<Scalar>; ++lane) {
            if (node.child[lane] >= 0 || node.bounds[0][0][lane] > node.bounds[0][1][lane]) continue;
            const auto corner = [&](int side) {
                return vec3<Scalar>(node.bounds[0][side][lane], node.bounds[1][side][lane], node.bounds[2][side][lane]);
            };
            take(compiled.sphere_tree.blocks[static_cast<std::size_t>(~node.child[lane])], corner(0), corner(1));
        }
    return padded;
}

}  // namespace raypool::stability
