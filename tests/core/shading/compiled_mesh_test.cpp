/// Normals of meshes in the tables that kernels read.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/geometry/triangles.h"
#include "core/shading/compiled_scene.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

Scene with_a_material() {
    Scene scene;
    scene.textures.emplace_back();
    scene.materials.emplace_back();
    return scene;
}

/// By any transform: a triangle that has its own normal at each vertex still has it, and outward stays outward.
TEST(CompiledMesh, TakesNormalsToTheirPlaces) {
    RandomInputs random(6);
    int mirrored = 0;
    for (int i = 0; i < 1000; ++i) {
        Mesh mesh;
        Scene scene = with_a_material();
        const std::array<Vec3<double>, 3> corners{random.point<double>(1), random.point<double>(1),
                                                  random.point<double>(1)};
        const Vec3<double> normal = random.uniform(0.1, 10) * triangle_normal<double>(corners);
        for (const Vec3<double>& corner : corners) {
            mesh.positions.push_back(
                {static_cast<float>(corner[0]), static_cast<float>(corner[1]), static_cast<float>(corner[2])});
            mesh.normals.push_back(
                {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])});
        }
        mesh.triangles = {{0, 1, 2}};
        MeshShape shape{std::make_shared<const Mesh>(std::move(mesh))};
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) shape.transform(row, column) = random.uniform(-2, 2);
        if (std::abs(shape.transform.leftCols<3>().determinant()) < 0.3) continue;
        mirrored += shape.is_mirrored() ? 1 : 0;
        scene.meshes.push_back(shape);

        const CompiledScene<double> compiled = compile<double>(scene);
        std::array<Vec3<double>, 3> placed;
        std::array<Vec3<double>, 3> normals;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto id = static_cast<std::size_t>(bits_of<double>(compiled.triangles[0].value[k]));
            const double* row = compiled.vertices[id].value;
            placed[k] = vec3<double>(row[0], row[1], row[2]);
            const double* at = compiled.vertex_normals.data() + 3 * bits_of<double>(row[VertexRow<double>::kNormal]);
            normals[k] = vec3<double>(at[0], at[1], at[2]);
        }
        for (const Vec3<double>& at_vertex : normals)
            EXPECT_NEAR((at_vertex - triangle_normal<double>(placed)).norm(), 0, 1e-4) << shape.transform;
    }
    EXPECT_GT(mirrored, 200);
    EXPECT_LT(mirrored, 700);
}

TEST(CompiledMesh, NumbersNormalsOverMeshesThatHaveSomeAndNone) {
    Mesh flat;
    flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    flat.triangles = {{0, 1, 2}};
    Mesh partly = flat;
    partly.normals = {{0, 0, 2}, {0, 0, 0}, {0, 3, 0}};
    Scene scene = with_a_material();
    for (const Mesh& mesh : {partly, flat, partly}) scene.meshes.push_back({std::make_shared<const Mesh>(mesh)});
    const CompiledScene<float> compiled = compile<float>(scene);
    std::vector<int> numbers;
    for (const VertexRow<float>& row : compiled.vertices)
        numbers.push_back(bits_of<float>(row.value[VertexRow<float>::kNormal]));
    EXPECT_EQ(numbers, (std::vector<int>{0, -1, 1, -1, -1, -1, 2, -1, 3}));
    EXPECT_EQ(std::vector<float>(compiled.vertex_normals.begin(), compiled.vertex_normals.end()),
              (std::vector<float>{0, 0, 1, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0}));
    scene.meshes = {{std::make_shared<const Mesh>(flat)}};
    EXPECT_TRUE(compile<float>(scene).vertex_normals.empty());
}

}  // namespace
}  // namespace raypool::test
