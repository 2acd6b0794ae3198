#include "bench/peers/embree_bvh.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <new>
#include <utility>

#include "bench/peers/embree_device.h"
#include "core/base/clock.h"
#include "core/base/error.h"

namespace raypool::peers {

namespace {

/// A node as Embree has us make it, in the memory of its tree.
struct Node {
    std::array<RTCBounds, 2> bounds;  ///< of an inner node's children
    std::array<void*, 2> child;
    std::uint32_t count;  ///< of boxes in a leaf; 0: an inner node
    std::array<std::uint32_t, RTC_BUILD_MAX_PRIMITIVES_PER_LEAF> box;
};

Node* new_node(RTCThreadLocalAllocator allocator, std::uint32_t count) {
    // An inner node ends where the boxes of a leaf begin.
    const std::size_t bytes = offsetof(Node, box) + count * sizeof(std::uint32_t);
    auto* node = static_cast<Node*>(rtcThreadLocalAlloc(allocator, bytes, alignof(Node)));
    node->count = count;
    return node;
}
void* create_inner(RTCThreadLocalAllocator allocator, unsigned /*children*/, void* /*user*/) {
    return new_node(allocator, 0);
}
void set_children(void* node, void** children, unsigned count, void* /*user*/) {
    std::copy_n(children, count, static_cast<Node*>(node)->child.begin());
}
void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void* /*user*/) {
    for (unsigned i = 0; i < count; ++i) static_cast<Node*>(node)->bounds[i] = *bounds[i];
}
void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                  void* /*user*/) {
    Node* node = new_node(allocator, static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i) node->box[i] = primitives[i].primID;
    return node;
}

std::vector<RTCBuildPrimitive> primitives_of(const std::vector<Box>& boxes) {
    std::vector<RTCBuildPrimitive> primitives(boxes.size());
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Eigen::Vector3f low = boxes[i].low.cast<float>();
        const Eigen::Vector3f high = boxes[i].high.cast<float>();
        primitives[i] = {low[0], low[1], low[2], 0, high[0], high[1], high[2], static_cast<unsigned>(i)};
    }
    return primitives;
}

Box box_of(const RTCBounds& bounds) {
    return {{bounds.lower_x, bounds.lower_y, bounds.lower_z}, {bounds.upper_x, bounds.upper_y, bounds.upper_z}};
}

BinaryBvh binary_bvh(const Node& root, const std::vector<Box>& boxes) {
    BinaryBvh tree;
    tree.order.reserve(boxes.size());
    Box all;
    for (const Box& box : boxes) all.extend(box);
    tree.nodes.push_back({.box = all});
    std::vector<std::pair<const Node*, std::uint32_t>> open{{&root, 0}};
    while (!open.empty()) {
        const auto [node, index] = open.back();
        open.pop_back();
        if (node->count > 0) {
            tree.nodes[index].first = static_cast<std::uint32_t>(tree.order.size());
            tree.nodes[index].count = node->count;
            tree.order.insert(tree.order.end(), node->box.begin(), node->box.begin() + node->count);
            continue;
        }
        const auto left = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[index].left = left;
        for (std::uint32_t i = 0; i < 2; ++i) {
            tree.nodes.push_back({.box = box_of(node->bounds[i])});
            open.emplace_back(static_cast<const Node*>(node->child[i]), left + i);
        }
    }
    return tree;
}

}  // namespace

EmbreeBvh embree_bvh(const std::vector<Box>& boxes, std::uint32_t block, int threads) {
    RAYPOOL_CHECK(block > 0 && block <= RTC_BUILD_MAX_PRIMITIVES_PER_LEAF, "a leaf of Embree's holds so many");
    if (boxes.empty()) return {};
    const auto device = embree_device(threads);
    const Owned<RTCBVH, rtcReleaseBVH> bvh(rtcNewBVH(device.get()));
    std::vector<RTCBuildPrimitive> primitives = primitives_of(boxes);

    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.maxDepth = kMostSahLevels;
    arguments.sahBlockSize = block;
    arguments.maxLeafSize = block;
    arguments.bvh = bvh.get();
    arguments.primitives = primitives.data();
    arguments.primitiveCount = primitives.size();
    arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = create_inner;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = set_bounds;
    arguments.createLeaf = create_leaf;

    omp_pause_resource_all(
        omp_pause_soft);  // else its threads wait for work, busily, on the cores that Embree builds on
    const double start = wall_seconds();
    const auto* root = static_cast<const Node*>(rtcBuildBVH(&arguments));
    const double seconds = wall_seconds() - start;
    if (root == nullptr) throw std::runtime_error("Embree built no tree");
    return {binary_bvh(*root, boxes), seconds};
}

}  // namespace raypool::peers
