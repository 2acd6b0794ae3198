/// Spheres as compile() puts them into its trees: with their padded radius, and with the box of the leaf they are in.
#pragma once

#include <bit>
#include <vector>

#include "core/shading/compiled_scene.h"
#include "tests/random_inputs.h"

namespace raypool::stability {

/// A leaf's box over the whole shutter, and the line that each side of it follows: [0] low, [1] high. Infinite where
/// there is no leaf, of a sphere that is set aside as large.
template <class Scalar>
struct LeafBox {
    Vec3<Scalar> bounds[2];
    Vec3<Scalar> start[2];
    Vec3<Scalar> change[2];

    [[nodiscard]] Scalar at(int side, int axis, Scalar time) const {
        return mad<Scalar>(time, change[side][axis], start[side][axis]);
    }
};

template <class Scalar>
struct PaddedSphere {
    Vec3<Scalar> center;
    Vec3<Scalar> motion;
    Scalar radius;
    Scalar padded_radius;
    LeafBox<Scalar> leaf;
};

/// In the order in which they are given.
template <class Scalar>
std::vector<PaddedSphere<Scalar>> padded_spheres(const std::vector<Sphere>& spheres) {
    Scene scene;
    scene.textures.emplace_back();
    scene.materials.emplace_back();
    scene.camera.shutter_close = 1;
    scene.spheres = spheres;
    for (Sphere& sphere : scene.spheres) sphere.material_id = 0;
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);

    std::vector<PaddedSphere<Scalar>> padded(spheres.size());
    const auto take = [&](const auto& block, const LeafBox<Scalar>& leaf) {
        for (int lane = 0; lane < block.kLanes; ++lane) {
            if (block.id[lane] == kNoPrimitive) continue;
            const auto part = [&](const auto& column) {
                return vec3<Scalar>(column[0][lane], column[1][lane], column[2][lane]);
            };
            padded[static_cast<std::size_t>(block.id[lane])] = {part(block.center), part(block.motion),
                                                                block.radius[lane], block.padded_radius[lane], leaf};
        }
    };
    const Vec3<Scalar> far = Vec3<Scalar>::Constant(kInfinity<Scalar>);
    const Vec3<Scalar> none = Vec3<Scalar>::Zero();
    for (const auto& block : compiled.large_spheres) take(block, {{-far, far}, {-far, far}, {none, none}});
    const auto& tree = compiled.sphere_tree;
    for (std::size_t node = 0; node < tree.nodes.size(); ++node)
        for (int lane = 0; lane < kTreeWidth<Scalar>; ++lane) {
            const auto& bounds = tree.nodes[node].bounds;
            const std::int32_t child = tree.nodes[node].child[lane];
            if (child >= 0 || bounds[0][0][lane] > bounds[0][1][lane]) continue;
            LeafBox<Scalar> leaf{{none, none}, {none, none}, {none, none}};
            for (int side = 0; side < 2; ++side)
                for (int axis = 0; axis < 3; ++axis) {
                    leaf.bounds[side][axis] = leaf.start[side][axis] = bounds[axis][side][lane];
                    if (tree.motion[axis].empty()) continue;
                    leaf.start[side][axis] = tree.motion[axis][node].start[side][lane];
                    leaf.change[side][axis] = tree.motion[axis][node].change[side][lane];
                }
            take(tree.blocks[static_cast<std::size_t>(~child)], leaf);
        }
    return padded;
}

template <class Scalar>
const PaddedSphere<Scalar>& any_of(const std::vector<PaddedSphere<Scalar>>& spheres, test::RandomInputs& random) {
    return spheres[static_cast<std::size_t>(random.below(static_cast<int>(spheres.size())))];
}

}  // namespace raypool::stability
