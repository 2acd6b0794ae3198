// Instances make the image of the meshes that they stand for, by every engine.

#include <gtest/gtest.h>

#include <memory>

#include <Eigen/Geometry>

#include "core/base/error.h"
#include "core/scene/scene_hash.h"
#include "tests/equivalence/every_nth.h"
#include "tests/equivalence/same_image.h"
#include "tests/meshes.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

namespace raypool {
namespace {

using namespace wavefront;

/// The committed scene of them, or with `are_instances` false all of its meshes as they stand.
Scene scene_of_instances(bool are_instances) {
    Scene scene = small_scene("instances", 24);
    for (MeshShape& shape : scene.meshes) shape.is_instance = shape.is_instance && are_instances;
    return scene;
}

/// Moved by sums that are exact and scaled by powers of two, on some axes mirrored. Normals of smooth ones are those of
/// a transform that scales all axes alike.
Scene with_exact_transforms() {
    Scene scene = scene_of_instances(true);
    int i = 0;
    for (MeshShape& shape : scene.meshes) {
        const auto coarse = [](double x) { return std::round(x * 256) / 256; };
        Mesh mesh = *shape.mesh;
        for (auto& position : mesh.positions)
            for (float& x : position) x = static_cast<float>(coarse(double{x}));
        shape.mesh = std::make_shared<const Mesh>(std::move(mesh));
        const Vector3d place = shape.transform.col(3).unaryExpr(coarse);
        const double scale = std::exp2(i % 3 - 2);
        const bool is_smooth = !shape.mesh->normals.empty();
        shape.transform =
            (Eigen::Translation3d(place) *
             Eigen::Scaling(Vector3d(is_smooth || i % 2 == 0 ? scale : -scale, scale, is_smooth ? scale : scale / 2)))
                .affine();
        ++i;
    }
    return scene;
}

RenderSettings settings_of(LightSampling light_sampling) {
    RenderSettings settings;
    settings.end_sample = 4;
    settings.depth = 20;
    settings.light_sampling = light_sampling;
    return settings;
}

template <class Scalar>
void expect_the_image_of_meshes() {
    Scene scene = with_exact_transforms();
    const CompiledScene<Scalar> instances = compile<Scalar>(scene);
    for (MeshShape& shape : scene.meshes) shape.is_instance = false;
    const CompiledScene<Scalar> meshes = compile<Scalar>(scene);
    ASSERT_GT(instances.instance_tree.blocks.size(), 6U);
    ASSERT_TRUE(meshes.instance_tree.blocks.empty());
    for (const LightSampling light_sampling : {LightSampling::None, LightSampling::Mis}) {
        const RenderSettings settings = settings_of(light_sampling);
        const Rendered expected = render(recursive::RecursiveEngine(), meshes, settings);
        ASSERT_TRUE(same_image("exact_instances", expected, render(recursive::RecursiveEngine(), instances, settings),
                               "recursive"));
        ASSERT_TRUE(same_image("exact_instances", expected, render(WavefrontEngine({}), instances, settings), "pool"));
    }
}
TEST(Instances, MakeTheImageOfMeshesWhereTransformsAreExact) {
    expect_the_image_of_meshes<float>();
    expect_the_image_of_meshes<double>();
}

/// Elsewhere the rounding of vertices differs, so the means agree and not the bits.
TEST(Instances, StandWhereMeshesWould) {
    const RenderSettings settings = settings_of(LightSampling::Mis);
    const Rendered instances =
        render(recursive::RecursiveEngine(), compile<double>(scene_of_instances(true)), settings);
    const Rendered meshes = render(recursive::RecursiveEngine(), compile<double>(scene_of_instances(false)), settings);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(instances.mean(channel), meshes.mean(channel), 0.02 * meshes.mean(channel));
}

template <class Scalar>
void expect_one_image_of_all_rungs() {
    const CompiledScene<Scalar> scene = compile<Scalar>(scene_of_instances(true));
    EveryNth some(5);
    for (const LightSampling light_sampling : {LightSampling::None, LightSampling::Light, LightSampling::Mis}) {
        for (const int split_depth : {0, 2}) {
            RenderSettings settings = settings_of(light_sampling);
            settings.split_depth = split_depth;
            settings.sampler = split_depth == 0 ? Sampler::Independent : Sampler::Sobol;
            const Rendered expected = render(recursive::RecursiveEngine(), scene, settings);
            ASSERT_TRUE(
                same_image("instances", expected, render(recursive::IterativeEngine(), scene, settings), "iterative"));
            for (const Rung& rung : ladder(2)) {
                for (const int threads : {1, 3}) {
                    for (const std::int64_t rays : {17, 500, 20000}) {
                        if (!some.takes_next()) continue;
                        settings.threads = threads;
                        PoolSettings pool = rung.pool;
                        pool.capacity = rays;
                        ASSERT_TRUE(same_image("instances", expected, render(WavefrontEngine(pool), scene, settings),
                                               rung.name));
                    }
                }
            }
        }
    }
}
TEST(Instances, MakeOneImageOnAllRungs) {
    expect_one_image_of_all_rungs<float>();
    expect_one_image_of_all_rungs<double>();
}

/// Of objects that shine each triangle is a light, and none of what is compiled is an instance.
TEST(Instances, AreMeshesWhereTheyShine) {
    Scene scene = scene_of_instances(true);
    for (MeshShape& shape : scene.meshes) shape.material_id = 0;
    scene.materials[0].kind = Material::Kind::Emissive;
    const CompiledScene<float> compiled = compile<float>(scene);
    EXPECT_TRUE(compiled.instance_tree.blocks.empty());
    EXPECT_GT(compiled.lights.size(), compiled.triangles.size() / 2);
}

/// An object whose triangles have no area is not there, and its instances hide nothing of others.
TEST(Instances, OfNothingAreNotThere) {
    Scene scene = scene_of_instances(true);
    const std::string before =
        render(recursive::RecursiveEngine(), compile<float>(scene), settings_of(LightSampling::None)).hash();
    Mesh flat;
    flat.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    flat.triangles = {{0, 1, 2}, {0, 0, 1}};
    for (const Mesh& nothing : {flat, Mesh{}}) {
        MeshShape shape{std::make_shared<const Mesh>(nothing)};
        shape.is_instance = true;
        shape.material_id = scene.meshes.front().material_id;
        scene.meshes.push_back(shape);
        EXPECT_EQ(render(recursive::RecursiveEngine(), compile<float>(scene), settings_of(LightSampling::None)).hash(),
                  before);
        EXPECT_EQ(render(WavefrontEngine({}), compile<float>(scene), settings_of(LightSampling::None)).hash(), before);
    }
}

TEST(Instances, AreHashedWithTheirScene) {
    const Scene scene = scene_of_instances(true);
    const std::string hash = scene_hash(scene);
    Scene other = scene;
    std::swap(other.meshes[3].mesh, other.meshes[4].mesh);
    EXPECT_NE(scene.meshes[3].mesh, scene.meshes[4].mesh);
    EXPECT_NE(scene_hash(other), hash);
    other = scene;
    other.meshes[3].is_instance = false;
    EXPECT_NE(scene_hash(other), hash);
    other = scene;
    other.meshes[3].transform(0, 3) += 1;
    EXPECT_NE(scene_hash(other), hash);
    other = scene;
    other.meshes[3].material_id = other.meshes[3].material_id == 0 ? 1 : 0;
    EXPECT_NE(scene_hash(other), hash);
}

TEST(Instances, AreRefusedWhereTheyShowTooMuch) {
    Scene scene = test::scene_of(test::icosphere(6));  // 81,920 triangles
    scene.meshes[0].is_instance = true;
    scene.meshes.resize(6600, scene.meshes[0]);
    EXPECT_THROW(compile<float>(scene), InputError);
}

/// A thousand of a ball take no more memory than one ball and a row and a share of the tree each.
TEST(Instances, AreInMemoryOnce) {
    const auto bytes = [](int count) {
        Scene scene = test::scene_of(test::icosphere(3));
        scene.meshes[0].is_instance = true;
        for (int i = 1; i < count; ++i) {
            scene.meshes.push_back(scene.meshes[0]);
            scene.meshes.back().transform.col(3) = Vector3d(3.0 * (i % 10), 3.0 * (i / 10 % 10), 0.03 * i);
        }
        return compile<float>(scene).bytes();
    };
    EXPECT_LT(bytes(1001) - bytes(1), 1000U * 300);
}

}  // namespace
}  // namespace raypool
