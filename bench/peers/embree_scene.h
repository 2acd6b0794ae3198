/// A Scene in Embree 3: spheres and quads as user geometries with their own intersection functions, planes (which have
/// no box) tested by hand before, and a table of what the surfaces are made of.
///
/// Called by the peer's tracers. Immutable once made, and safe to trace from several threads. A primitive's id counts
/// spheres, quads, planes. A ray carries the id of the primitive it starts on in its `id` field; it cannot hit that
/// flat, and of that sphere it meets the far side only, so there is no least distance to choose.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "bench/peers/numbers.h"
#include "core/scene/scene.h"

namespace raypool::peers {

using PacketRay = std::conditional_t<kPacket == 16, RTCRay16, RTCRay8>;
using PacketRayHit = std::conditional_t<kPacket == 16, RTCRayHit16, RTCRayHit8>;

inline constexpr std::uint32_t kNothing = RTC_INVALID_GEOMETRY_ID;

struct SphereShape {
    V3<float> center;
    float radius;
    V3<float> motion;
};

/// A quad or a plane. (u, v) are the offset from the corner along the dual vectors.
struct PlanarShape {
    V3<float> corner, normal, dual_u, dual_v;
};

/// What Embree is given as the user pointer of a geometry.
template <class Shape>
struct ShapeTable {
    std::vector<Shape> shapes;
    std::vector<RTCBounds> bounds;
    std::uint32_t first_id = 0;
};

/// The columns of a primitive's row in the surface table.
struct Surface {
    enum Column : std::uint8_t {
        kShape = 0,       ///< a sphere's centre, a flat's normal
        kRadius = 3,      ///< 0 for a flat
        kMotion = 4,      ///<
        kMaterial = 7,    ///< Material::Kind
        kColour = 8,      ///<
        kParameter = 11,  ///< fuzz or index of refraction
        kTexture = 12,    ///< Texture::Kind
        kOdd = 13,        ///< the checker's other colour
        kOffset = 16,     ///< the checker's
        kDensity = 19,    ///< cells a unit
        kImage = 20,      ///< index into the scene's textures
        kRepeatU = 21,    ///< whether the image begins anew beyond its edges
        kRepeatV = 22,
        kColumns = 24
    };
};

class EmbreeScene {
  public:
    explicit EmbreeScene(const Scene& scene);
    EmbreeScene(const EmbreeScene&) = delete;  // Embree points into it
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene() = default;

    /// Closest hits of the rays, in place. Ids are in hit.primID, counted through all shapes, where hit.geomID is not
    /// kNothing. In a packet, is_active is -1 or 0 a lane.
    void intersect(RTCRayHit& ray) const;
    void intersect(const WideInt& is_active, PacketRayHit& rays) const;

    [[nodiscard]] const float* surfaces() const { return surfaces_.data(); }
    [[nodiscard]] const Texture& texture(int id) const { return textures_[static_cast<std::size_t>(id)]; }

  private:
    void add_surface(const Scene& scene, int material_id, V3<float> shape, float radius, V3<float> motion,
                     bool is_plane = false);
    template <class Shape>
    void attach(ShapeTable<Shape>& table, RTCIntersectFunctionN intersect);

    template <class RayHit, class Mask>
    void test_planes(Mask is_active, RayHit& rayhit) const;

    template <auto release>
    struct Release {
        template <class Handle>
        void operator()(Handle handle) const {
            release(handle);
        }
    };

    ShapeTable<SphereShape> spheres_;
    ShapeTable<PlanarShape> quads_;
    ShapeTable<PlanarShape> planes_;  ///< not Embree's: bounds stay empty
    std::vector<float> surfaces_;
    std::vector<Texture> textures_;
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release<rtcReleaseDevice>> device_;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, Release<rtcReleaseScene>> scene_;
};

}  // namespace raypool::peers
