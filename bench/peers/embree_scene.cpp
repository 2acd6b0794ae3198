#include "bench/peers/embree_scene.h"

#include <algorithm>
#include <stdexcept>

#include "core/geometry/node_motion.h"

namespace raypool::peers {

namespace {

/// One shape of a block by itself, so that a test reads a line or two of the cache. A block is columns of numbers of
/// four bytes, a lane each.
template <class Alone, class Block>
Alone shape_alone(const Block& block, int lane) {
    static_assert(sizeof(block.id) == 4 * Block::kLanes);
    constexpr std::size_t kColumns = std::min(sizeof(Alone) / 4, sizeof(Block) / (4 * Block::kLanes));
    Alone alone{};
    for (std::size_t column = 0; column < kColumns; ++column)
        std::memcpy(
            reinterpret_cast<char*>(&alone) + 4 * column,
            reinterpret_cast<const char*>(&block) + 4 * (column * Block::kLanes + static_cast<std::size_t>(lane)), 4);
    return alone;
}

/// The padded boxes of our own trees at times 0 and 1.
detail::EndBounds<float> end_bounds(const SphereBlock<float, 1>& sphere, int axis) {
    return detail::end_bounds(sphere, axis);
}
detail::EndBounds<float> end_bounds(const PlanarBlock<float, 1>& quad, int axis) {
    const float low = quad.low[axis][0];
    const float high = quad.high[axis][0];
    return {{low, low}, {high, high}};
}

/// With the room that our trees leave for boxes that move (node_motion.h).
template <class Block>
void set_bounds(const RTCBoundsFunctionArguments* args) {
    const Block& shape = static_cast<const Block*>(args->geometryUserPtr)[args->primID];
    float low[3];
    float high[3];
    for (int axis = 0; axis < 3; ++axis) {
        const detail::EndBounds<float> bounds = end_bounds(shape, axis);
        const float room = 16 * std::numeric_limits<float>::epsilon() * bounds.reach();
        low[axis] = bounds.low[args->timeStep] - room;
        high[axis] = bounds.high[args->timeStep] + room;
    }
    *args->bounds_o = {low[0], low[1], low[2], 0, high[0], high[1], high[2], 0};
}

}  // namespace

EmbreeScene::EmbreeScene(const CompiledScene<float>& scene, const ShapeFunctions& functions)
    : device_(rtcNewDevice("threads=1,set_affinity=0")) {
    if (!device_) throw std::runtime_error("Embree found no device");
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    attach(spheres_, scene.sphere_tree.blocks, scene.features.motion, functions.sphere);
    attach(quads_, scene.quad_tree.blocks, false, functions.quad);
    rtcCommitScene(scene_.get());
    if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::runtime_error("Embree refused the scene");
}

template <class Block, class Blocks>
void EmbreeScene::attach(std::vector<Block>& shapes, const Blocks& blocks, bool can_move,
                         RTCIntersectFunctionN intersect) {
    for (const auto& block : blocks)
        wavefront::for_each_shape(block, [&](int lane) { shapes.push_back(shape_alone<Block>(block, lane)); });
    if (shapes.empty()) return;
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(shapes.size()));
    rtcSetGeometryUserData(geometry, shapes.data());
    if (can_move) rtcSetGeometryTimeStepCount(geometry, 2);
    rtcSetGeometryBoundsFunction(geometry, set_bounds<Block>, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
}

}  // namespace raypool::peers
