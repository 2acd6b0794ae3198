#include "bench/peers/embree_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <stdexcept>

#include "core/base/clock.h"
#include "core/geometry/node_motion.h"

namespace raypool::peers {

namespace {

/// A block is columns of numbers of four bytes, a lane each: so this takes one lane of each.
template <class Alone, class Block>
Alone shape_alone(const Block& block, int lane) {
    constexpr std::size_t kRow = 4 * Block::kLanes;
    static_assert(sizeof(block.id) == kRow && sizeof(Alone::id) == 4);
    Alone alone{};
    const auto* from = reinterpret_cast<const char*>(&block) + 4 * lane;
    auto* to = reinterpret_cast<char*>(&alone);
    for (std::size_t i = 0; i < std::min(sizeof(Alone) / 4, sizeof(Block) / kRow); ++i)
        std::memcpy(to + 4 * i, from + kRow * i, 4);
    return alone;
}

template <class Block, class Blocks>
void add(const Blocks& blocks, Shapes<Block>& shapes) {
    for (const auto& block : blocks)
        for_each_shape(block, [&](int lane) { shapes.blocks.push_back(shape_alone<Block>(block, lane)); });
}

/// A shape's own padded box at times 0 and 1.
detail::EndBounds<float> end_bounds(const SphereBlock<float, 1>& sphere, int axis) {
    return detail::end_bounds(sphere, axis);
}
detail::EndBounds<float> end_bounds(const PlanarBlock<float, 1>& quad, int axis) {
    const float low = quad.low[axis][0];
    const float high = quad.high[axis][0];
    return {{low, low}, {high, high}};
}

detail::EndBounds<float> end_bounds(const TriangleBlock<float, 1>& triangle, int axis) {
    std::array<Vec3<float>, 3> vertex;
    for (int i = 0; i < 3; ++i)
        vertex[i] = vec3<float>(triangle.vertex[i][0][0], triangle.vertex[i][1][0], triangle.vertex[i][2][0]);
    Vec3<float> low;
    Vec3<float> high;
    triangle_box<float>(vertex, low, high);
    return {{low[axis], low[axis]}, {high[axis], high[axis]}};
}

template <class Block>
float greatest_coordinate(const Shapes<Block>& shapes) {
    float reach = 0;
    for (const Block& shape : shapes.blocks)
        for (int axis = 0; axis < 3; ++axis) reach = std::max(reach, end_bounds(shape, axis).reach());
    return reach;
}

float greatest_coordinate(std::span<const VertexRow<float>> vertices) {
    float reach = 0;
    for (const VertexRow<float>& vertex : vertices)
        for (int axis = 0; axis < 3; ++axis) reach = std::max(reach, std::abs(vertex.value[axis]));
    return reach;
}

template <class Block>
void set_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& shapes = *static_cast<const Shapes<Block>*>(args->geometryUserPtr);
    float low[3];
    float high[3];
    for (int axis = 0; axis < 3; ++axis) {
        const detail::EndBounds<float> bounds = end_bounds(shapes.blocks[args->primID], axis);
        low[axis] = bounds.low[args->timeStep] - shapes.room;
        high[axis] = bounds.high[args->timeStep] + shapes.room;
    }
    *args->bounds_o = {low[0], low[1], low[2], 0, high[0], high[1], high[2], 0};
}

/// Called by any thread of Embree's: with bytes that are taken, or given back (< 0). False would refuse them.
bool count_bytes(void* sum, ssize_t bytes, bool /*post*/) {
    *static_cast<std::atomic<std::ptrdiff_t>*>(sum) += bytes;
    return true;
}

}  // namespace

EmbreeScene::EmbreeScene(const CompiledScene<float>& scene, const ShapeFunctions& functions, EmbreeTriangles triangles,
                         const EmbreeBuild& build)
    : first_triangle_(scene.first_triangle), device_(embree_device(build.threads)) {
    rtcSetDeviceMemoryMonitorFunction(device_.get(), count_bytes, &bytes_);
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
    add(scene.sphere_tree.blocks, spheres_);
    add(scene.quad_tree.blocks, quads_);
    if (triangles == EmbreeTriangles::Ours) add(scene.triangle_tree.blocks, triangles_);
    // Embree 3 has no robust box test for user geometries, whatever the flags of a scene. The one that it has takes
    // products with the coordinates of a ray's origin, whose rounding is as if a box moved by an ulp of them; a box
    // that moves has five more (node_motion.h). So boxes leave room for both, of whatever rays start on but planes and
    // large spheres.
    const float reach = std::max({scene.camera.origin.cwiseAbs().maxCoeff(), greatest_coordinate(spheres_),
                                  greatest_coordinate(quads_), greatest_coordinate(scene.vertices)});
    spheres_.room = quads_.room = triangles_.room = 8 * std::numeric_limits<float>::epsilon() * reach;
    attach(spheres_, scene.features.motion, functions.sphere);
    attach(quads_, false, functions.quad);
    attach(triangles_, false, functions.triangle);
    if (triangles == EmbreeTriangles::Embrees) attach_triangles(scene, build.flags, functions.pass_light);
    const double start = wall_seconds();
    rtcCommitScene(scene_.get());
    build_seconds_ = wall_seconds() - start;
    if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::runtime_error("Embree refused the scene");
}

/// All in one geometry, so that primID counts as ids do. Those in no tree, which have no area, become points.
void EmbreeScene::attach_triangles(const CompiledScene<float>& scene, RTCSceneFlags flags,
                                   RTCFilterFunctionN pass_light) {
    if (scene.triangles.empty()) return;
    rtcSetSceneFlags(scene_.get(), flags);
    vertex_ids_.resize(scene.triangles.size());
    for (const auto& block : scene.triangle_tree.blocks) {
        for_each_shape(block, [&](int lane) {
            const auto number = static_cast<std::size_t>(block.id[lane] - first_triangle_);
            for (std::size_t i = 0; i < 3; ++i)
                vertex_ids_[number][i] = std::bit_cast<std::uint32_t>(scene.triangles[number].value[i]);
        });
    }
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene.vertices.data(), 0,
                               sizeof(VertexRow<float>), scene.vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, vertex_ids_.data(), 0,
                               sizeof(vertex_ids_[0]), vertex_ids_.size());
    if (scene.light_weights.size() > static_cast<std::size_t>(first_triangle_)) {  // triangles are lights
        rtcSetGeometryUserData(geometry, &first_triangle_);
        rtcSetGeometryOccludedFilterFunction(geometry, pass_light);
    }
    finish(geometry);
}

template <class Block>
void EmbreeScene::attach(Shapes<Block>& shapes, bool can_move, const ShapeFunctions::OfKind& functions) {
    if (shapes.blocks.empty()) return;
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(shapes.blocks.size()));
    rtcSetGeometryUserData(geometry, &shapes);
    if (can_move) rtcSetGeometryTimeStepCount(geometry, 2);
    rtcSetGeometryBoundsFunction(geometry, set_bounds<Block>, nullptr);
    rtcSetGeometryIntersectFunction(geometry, functions.intersect);
    rtcSetGeometryOccludedFunction(geometry, functions.occlude);
    finish(geometry);
}

void EmbreeScene::finish(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
}

}  // namespace raypool::peers
