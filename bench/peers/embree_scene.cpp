#include "bench/peers/embree_scene.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "bench/peers/shape_tests.h"

namespace raypool::peers {

namespace {

constexpr std::uint32_t kPlaneGeometry = kNothing - 1;

/// Wider by a little, so that no hit is lost to the rounding of the box test.
RTCBounds bounds(const Vector3d& low, const Vector3d& high) {
    const double reach = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    const Vector3d pad = Vector3d::Constant(1e-6 * reach);
    const V3<float> lower = to_v3(low - pad);
    const V3<float> upper = to_v3(high + pad);
    return {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, 0};
}

RTCBounds bounds(const Sphere& sphere) {
    const Vector3d radius = Vector3d::Constant(sphere.radius);
    return bounds(sphere.center0.cwiseMin(sphere.center1) - radius, sphere.center0.cwiseMax(sphere.center1) + radius);
}

RTCBounds bounds(const Quad& quad) {
    const Vector3d a = quad.corner;
    const Vector3d b = a + quad.edge_u;
    const Vector3d c = a + quad.edge_v;
    const Vector3d d = b + quad.edge_v;
    return bounds(a.cwiseMin(b).cwiseMin(c).cwiseMin(d), a.cwiseMax(b).cwiseMax(c).cwiseMax(d));
}

PlanarShape planar_shape(const Quad& quad) {
    const Vector3d normal = quad.edge_u.cross(quad.edge_v);
    const double square = normal.squaredNorm();
    return {to_v3(quad.corner), to_v3(normal.normalized()), to_v3(quad.edge_v.cross(normal) / square),
            to_v3(normal.cross(quad.edge_u) / square)};
}

/// As docs/scene-format.md leaves open, u runs along the x axis, or along z on a plane that faces x.
PlanarShape planar_shape(const Plane& plane) {
    const Vector3d normal = plane.normal.normalized();
    Vector3d u = std::abs(normal.x()) < 0.9 ? Vector3d(1, 0, 0) : Vector3d(0, 0, 1);
    u = (u - u.dot(normal) * normal).normalized();
    return {to_v3(plane.point), to_v3(normal), to_v3(u), to_v3(normal.cross(u))};
}

template <class Shape>
void copy_bounds(const RTCBoundsFunctionArguments* args) {
    *args->bounds_o = static_cast<const ShapeTable<Shape>*>(args->geometryUserPtr)->bounds[args->primID];
}

/// What Embree calls for one ray, or for a packet with some rays active.
template <class Shape, auto test_one, auto test_packet>
void intersect_shape(const RTCIntersectFunctionNArguments* args) {
    const auto& table = *static_cast<const ShapeTable<Shape>*>(args->geometryUserPtr);
    const Shape& shape = table.shapes[args->primID];
    const std::uint32_t id = table.first_id + args->primID;
    if (args->N == 1) {
        test_one(shape, id, args->geomID, args->valid[0] != 0, *reinterpret_cast<RTCRayHit*>(args->rayhit));
    } else {
        test_packet(shape, id, args->geomID, *reinterpret_cast<const WideInt*>(args->valid),
                    *reinterpret_cast<PacketRayHit*>(args->rayhit));
    }
}

constexpr auto kIntersectSphere = intersect_shape<SphereShape, test_sphere<RTCRayHit>, test_sphere<PacketRayHit>>;
constexpr auto kIntersectQuad =
    intersect_shape<PlanarShape, test_flat<Extent::Quad, RTCRayHit>, test_flat<Extent::Quad, PacketRayHit>>;

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene) : textures_(scene.textures) {
    for (const Sphere& sphere : scene.spheres) {
        const SphereShape shape{to_v3(sphere.center0), static_cast<float>(sphere.radius),
                                to_v3(sphere.center1 - sphere.center0)};
        spheres_.shapes.push_back(shape);
        spheres_.bounds.push_back(bounds(sphere));
        add_surface(scene, sphere.material_id, shape.center, shape.radius, shape.motion);
    }
    quads_.first_id = static_cast<std::uint32_t>(scene.spheres.size());
    for (const Quad& quad : scene.quads) {
        quads_.shapes.push_back(planar_shape(quad));
        quads_.bounds.push_back(bounds(quad));
        add_surface(scene, quad.material_id, quads_.shapes.back().normal, 0, {});
    }
    planes_.first_id = quads_.first_id + static_cast<std::uint32_t>(scene.quads.size());
    for (const Plane& plane : scene.planes) {
        planes_.shapes.push_back(planar_shape(plane));
        add_surface(scene, plane.material_id, planes_.shapes.back().normal, 0, {}, true);
    }
    surfaces_.resize(surfaces_.size() + Surface::kColumns);  // lanes that hit nothing look at row 0

    device_.reset(rtcNewDevice("threads=1,set_affinity=0"));
    if (!device_) throw std::runtime_error("Embree found no device");
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
    attach(spheres_, kIntersectSphere);
    attach(quads_, kIntersectQuad);
    rtcCommitScene(scene_.get());
    if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::runtime_error("Embree refused the scene");
}

void EmbreeScene::add_surface(const Scene& scene, int material_id, V3<float> shape, float radius, V3<float> motion,
                              bool is_plane) {
    const Material& material = scene.materials[static_cast<std::size_t>(material_id)];
    float row[Surface::kColumns]{};
    const auto put = [&](int column, const Vector3d& v) {
        for (int i = 0; i < 3; ++i) row[column + i] = static_cast<float>(v[i]);
    };
    row[Surface::kShape] = shape.x, row[Surface::kShape + 1] = shape.y, row[Surface::kShape + 2] = shape.z;
    row[Surface::kRadius] = radius;
    row[Surface::kMotion] = motion.x, row[Surface::kMotion + 1] = motion.y, row[Surface::kMotion + 2] = motion.z;
    row[Surface::kMaterial] = static_cast<float>(material.kind);
    if (material.kind == Material::Kind::Dielectric) {
        put(Surface::kColour, {1, 1, 1});
        row[Surface::kParameter] = static_cast<float>(material.ior);
    } else {
        const Texture& texture = textures_[static_cast<std::size_t>(material.texture_id)];
        put(Surface::kColour, texture.even);
        row[Surface::kParameter] = static_cast<float>(material.fuzz);
        row[Surface::kTexture] = static_cast<float>(texture.kind);
        put(Surface::kOdd, texture.odd);
        put(Surface::kOffset, texture.offset);
        row[Surface::kDensity] = static_cast<float>(1 / texture.scale);
        row[Surface::kImage] = static_cast<float>(material.texture_id);
        const bool is_sphere = radius > 0;
        const bool repeats = texture.wrap == Texture::Wrap::Repeat ||
                             (texture.wrap == Texture::Wrap::ByShape && (is_sphere || is_plane));
        row[Surface::kRepeatU] = repeats ? 1.0F : 0.0F;
        row[Surface::kRepeatV] = repeats && !is_sphere ? 1.0F : 0.0F;
    }
    surfaces_.insert(surfaces_.end(), std::begin(row), std::end(row));
}

template <class Shape>
void EmbreeScene::attach(ShapeTable<Shape>& table, RTCIntersectFunctionN intersect) {
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(table.shapes.size()));
    rtcSetGeometryUserData(geometry, &table);
    rtcSetGeometryBoundsFunction(
        geometry, [](const auto* args) { copy_bounds<Shape>(args); }, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
}

template <class RayHit, class Mask>
void EmbreeScene::test_planes(Mask is_active, RayHit& rayhit) const {
    std::uint32_t id = planes_.first_id;
    for (const PlanarShape& plane : planes_.shapes)
        test_flat<Extent::Plane>(plane, id++, kPlaneGeometry, is_active, rayhit);
}

void EmbreeScene::intersect(RTCRayHit& ray) const {
    ray.hit.geomID = kNothing;
    test_planes(true, ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &ray);
}

void EmbreeScene::intersect(const WideInt& is_active, PacketRayHit& rays) const {
    lanes(rays.hit.geomID) = WideUint{} + kNothing;
    test_planes(is_active, rays);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const auto* valid = reinterpret_cast<const int*>(&is_active);
#ifdef __AVX512F__
    rtcIntersect16(valid, scene_.get(), &context, &rays);
#else
    rtcIntersect8(valid, scene_.get(), &context, &rays);
#endif
}

}  // namespace raypool::peers
