/// What is built by threads is the same, bit for bit, for any number of them: trees, tables, and which shapes coincide.
#include <omp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/geometry/bvh.h"
#include "core/shading/compiled_scene.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

constexpr int kThreadCounts[] = {2, 3, 8};

/// What OpenMP gives a parallel region that asks for nothing.
class DefaultThreads {
  public:
    explicit DefaultThreads(int count) : before_(omp_get_max_threads()) { omp_set_num_threads(count); }
    ~DefaultThreads() { omp_set_num_threads(before_); }
    DefaultThreads(const DefaultThreads&) = delete;
    DefaultThreads& operator=(const DefaultThreads&) = delete;

  private:
    int before_;
};

/// As many as several threads share out: strewn, in a far cluster, in one place, and with zeros of both signs.
std::vector<Box> boxes_of_all_kinds() {
    RandomInputs random(1);
    std::vector<Box> boxes;
    const auto add = [&](const Eigen::Vector3d& center, double half_edge) {
        boxes.push_back({center.array() - half_edge, center.array() + half_edge});
    };
    for (int i = 0; i < 80'000; ++i) {
        const Eigen::Vector3d center = random.point<double>(10);
        add(center, std::exp(random.uniform(-8, 0)));
        add(Eigen::Vector3d(500, 0, 0) + 1e-3 * center, 1e-5);
        if (i % 3 == 0) add({1, 2, 3}, 0.5);
        if (i % 3 == 1) boxes.push_back({{-0.0, 0.0, -1.0}, {0.0, -0.0, random.one_in(2) ? 0.0 : -0.0}});
    }
    return boxes;
}

/// Doubles by their bits: zeros of either sign differ.
std::vector<std::uint64_t> words_of(const BinaryBvh& tree) {
    std::vector<std::uint64_t> words(tree.order.begin(), tree.order.end());
    for (const BinaryBvh::Node& node : tree.nodes) {
        words.insert(words.end(), {node.left, node.first, node.count});
        for (const double value :
             {node.box.low[0], node.box.low[1], node.box.low[2], node.box.high[0], node.box.high[1], node.box.high[2]})
            words.push_back(std::bit_cast<std::uint64_t>(value));
    }
    return words;
}

TEST(BinaryBvh, IsTheSameForAnyNumberOfThreads) {
    const std::vector<Box> boxes = boxes_of_all_kinds();
    for (const std::uint32_t block : {1U, 8U}) {
        const auto built_by = [&](int threads) {
            const DefaultThreads scope(threads);
            return words_of(build_binary_bvh(boxes, block));
        };
        const std::vector<std::uint64_t> by_one = built_by(1);
        for (const int threads : kThreadCounts) EXPECT_EQ(built_by(threads), by_one) << threads << " threads";
    }
}

TEST(BinaryBvh, OfLeavesLargerThanASubtreeIsOneLeaf) {
    const BinaryBvh tree = build_binary_bvh(boxes_of_all_kinds(), 1'000'000);
    EXPECT_EQ(tree.nodes.size(), 1U);
}

/// Spheres and quads of which some are listed twice, and some lie in one plane.
Scene scene_with_copies() {
    RandomInputs random(2);
    Scene scene;
    scene.textures.emplace_back().even = {0.5, 0.5, 0.5};
    scene.materials.emplace_back();
    for (int i = 0; i < 20'000; ++i) {
        const Eigen::Vector3d center = random.point<double>(10);
        scene.spheres.push_back({center, center, 0.05, 0});
        if (random.one_in(5)) scene.spheres.push_back(scene.spheres[static_cast<std::size_t>(random.below(i + 1))]);

        const Eigen::Vector3d corner = random.point<double>(10);
        const Eigen::Vector3d u = 0.2 * random.direction<double>();
        const Eigen::Vector3d v = u.cross(0.2 * random.direction<double>());
        scene.quads.push_back({corner, u, v, 0});
        if (random.one_in(5)) scene.quads.push_back({corner + 0.5 * u, u, v, 0});
    }
    return scene;
}

template <class T>
void append_bytes(std::vector<std::byte>& bytes, const T* values, std::size_t count) {
    const auto* first = reinterpret_cast<const std::byte*>(values);
    bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

/// Of what kernels read, without padding.
std::vector<std::byte> bytes_of(const CompiledScene<float>& scene) {
    std::vector<std::byte> bytes;
    append_bytes(bytes, scene.surfaces.data(), scene.surfaces.size());
    append_bytes(bytes, scene.planars.data(), scene.planars.size());
    const auto append_tree = [&](const auto& tree) {
        for (const auto& node : tree.nodes) {
            append_bytes(bytes, &node.bounds, 1);
            append_bytes(bytes, &node.child, 1);
        }
        for (const auto& block : tree.blocks) append_bytes(bytes, &block.id, 1);
    };
    append_tree(scene.sphere_tree);
    append_tree(scene.triangle_tree);
    append_tree(scene.quad_tree);
    return bytes;
}

TEST(Compile, MakesTheSameTablesForAnyNumberOfThreads) {
    const Scene scene = scene_with_copies();
    const auto compiled_by = [&](int threads) {
        const DefaultThreads scope(threads);
        return bytes_of(compile<float>(scene));
    };
    const std::vector<std::byte> by_one = compiled_by(1);
    for (const int threads : kThreadCounts) EXPECT_TRUE(compiled_by(threads) == by_one) << threads << " threads";
}

TEST(FindCoincidence, FindsTheSameForAnyNumberOfThreads) {
    const Scene scene = scene_with_copies();
    const auto found_by = [&](int threads) {
        const DefaultThreads scope(threads);
        const Coincidence found = find_coincidence<float>(scene);
        std::vector<std::uint32_t> ids(found.is_hidden.begin(), found.is_hidden.end());
        for (const Coincidence::Planar& planar : found.planars) ids.push_back(planar.group);
        return ids;
    };
    const std::vector<std::uint32_t> by_one = found_by(1);
    const std::size_t hidden = scene.spheres.size() - 20'000;
    EXPECT_EQ(std::count(by_one.begin(), by_one.begin() + static_cast<std::ptrdiff_t>(scene.spheres.size()), 1U),
              static_cast<std::ptrdiff_t>(hidden));
    for (const int threads : kThreadCounts) EXPECT_EQ(found_by(threads), by_one) << threads << " threads";
}

}  // namespace
}  // namespace raypool::test
