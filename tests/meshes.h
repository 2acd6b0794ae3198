/// Meshes for tests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "core/scene/scene.h"
#include "tests/random_inputs.h"

namespace raypool::test {

/// A sphere of 20 4^levels triangles, closed and convex but for rounding, around the origin, of radius 1.
inline Mesh icosphere(int levels) {
    const float g = (1 + std::sqrt(5.0F)) / 2;
    Mesh mesh;
    mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                      {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), 0);
            if (is_new) {
                place->second = static_cast<std::uint32_t>(mesh.positions.size());
                std::array<float, 3> between;
                for (int i = 0; i < 3; ++i) between[i] = (mesh.positions[a][i] + mesh.positions[b][i]) / 2;
                mesh.positions.push_back(between);
            }
            return place->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b);
            const std::uint32_t bc = middle(b, c);
            const std::uint32_t ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (auto& [x, y, z] : mesh.positions) {
        const double length = std::sqrt(double{x} * x + double{y} * y + double{z} * z);
        for (float* value : {&x, &y, &z}) *value = static_cast<float>(*value / length);
    }
    return mesh;
}

/// The same with the normals of the sphere.
inline Mesh smooth_icosphere(int levels) {
    Mesh mesh = icosphere(levels);
    mesh.normals = mesh.positions;
    return mesh;
}

/// A mesh on its own, grey, moved by `offset`.
inline Scene scene_of(Mesh mesh, const Vector3d& offset = Vector3d::Zero()) {
    Scene scene;
    scene.textures.emplace_back().even = Vector3d::Constant(0.8);
    scene.materials.emplace_back();
    MeshShape shape{std::make_shared<const Mesh>(std::move(mesh))};
    shape.transform.col(3) = offset;
    scene.meshes.push_back(std::move(shape));
    return scene;
}

/// Triangles at random in a cube from -6 to 6: some large, some needles, some twice, some without an area.
inline Mesh triangle_soup(int count, RandomInputs& random) {
    Mesh mesh;
    const auto add = [&](const Vector3d& point) {
        mesh.positions.push_back(
            {static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])});
        return static_cast<std::uint32_t>(mesh.positions.size()) - 1;
    };
    for (int i = 0; i < count; ++i) {
        const Vector3d corner = i % 3 == 0 ? random.lattice_point<double>(5) : random.point<double>(6);
        const Vector3d edge = random.uniform(0.1, 3) * random.direction<double>();
        const Vector3d across = (i % 7 == 0 ? 1e-3 : 1) * random.uniform(0.1, 3) * random.direction<double>();
        const std::uint32_t a = add(corner);
        const std::uint32_t b = add(corner + edge);
        const std::uint32_t c = i % 11 == 0 ? b : add(corner + edge + across);
        mesh.triangles.push_back({a, b, c});
        if (i % 5 == 0) mesh.triangles.push_back({b, c, a});
    }
    return mesh;
}

}  // namespace raypool::test
