/// The scene as its author wrote it: plain values in double precision, in scene units, seconds and degrees.
///
/// Made by scene_reader.h (from JSON) or by hand; turned into the tables that the engines read by compiled_scene.h.
/// The reader lets only values within the ranges given here pass; a program that makes a scene keeps to them. Ids are
/// indices into the vectors below. Radiance and colours are linear RGB with the primaries of sRGB.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/image/image.h"
#include "core/scene/mesh.h"

namespace raypool {

using Vector3d = Eigen::Vector3d;

/// A thin-lens camera ("Ray Tracing in One Weekend", chapters 12 and 13).
struct CameraDescription {
    Vector3d look_from{0, 0, 0};
    Vector3d look_at{0, 0, -1};        ///< differs from look_from
    Vector3d up{0, 1, 0};              ///< not parallel to the view direction
    double vertical_fov_degrees = 40;  ///< in (0, 180)
    double defocus_angle_degrees =
        0;                      ///< full angle of the cone of rays at the plane of focus, in [0, 180); 0 = pinhole
    double focus_distance = 0;  ///< > 0 when defocus_angle_degrees > 0; unused otherwise
    double shutter_open = 0;    ///< in [0, 1], the time at which moving shapes are at center0 being 0 ...
    double shutter_close = 0;   ///< ... and at center1 being 1; shutter_open <= shutter_close <= 1
};

/// Radiance of a ray that leaves the scene: bottom + s (top - bottom), s = (d.y + 1) / 2 for the unit direction d; or,
/// where there is an image, that of the texel in this direction times `scale`.
struct Background {
    Vector3d bottom{0, 0, 0};  ///< each component in [0, 1e6]
    Vector3d top{0, 0, 0};     ///< equal to bottom for a constant background
    /// Equirectangular, twice as wide as high, finite and not negative: +y at its top, -z at its centre, +x at three
    /// quarters of its width.
    std::shared_ptr<const Image> image = nullptr;
    double rotation_degrees = 0;  ///< of the image around the y axis, counterclockwise as seen from +y
    double scale = 1;             ///< of the image, > 0; the product is in [0, 1e6]

    /// No channel is above it in any direction.
    [[nodiscard]] double brightest() const {
        return image ? scale * *std::max_element(image->rgb.begin(), image->rgb.end())
                     : std::max(bottom.maxCoeff(), top.maxCoeff());
    }
};

struct Texture {
    enum class Kind : std::uint8_t { Solid, Checker3d, CheckerUv, Image };
    /// What lies beyond an image's edge: the opposite edge, or the edge itself. Around a sphere u meets itself, at its
    /// poles v ends: Repeat leaves v clamped there. ByShape repeats on planes and around spheres, and clamps on quads.
    enum class Wrap : std::uint8_t { ByShape, Repeat, Clamp };
    Kind kind = Kind::Solid;
    Vector3d even{0, 0,
                  0};  ///< the colour of Solid; the colour of the checker cells whose indices add up to an even number
    Vector3d odd{0, 0, 0};     ///< the other cells' colour
    double scale = 1;          ///< edge of a checker cell, > 0: in scene units (Checker3d) or in u and v (CheckerUv)
    Vector3d offset{0, 0, 0};  ///< Checker3d: cell boundaries lie where (p + offset) / scale is whole
    std::shared_ptr<const Image> image;  ///< Image only: values in [0, 1]; shared, since scenes are copied
    Wrap wrap = Wrap::ByShape;           ///< Image only

    /// No channel is above it anywhere.
    [[nodiscard]] double brightest() const { return image ? 1 : std::max(even.maxCoeff(), odd.maxCoeff()); }
    [[nodiscard]] bool needs_uv() const { return kind == Kind::CheckerUv || kind == Kind::Image; }
};

struct Material {
    enum class Kind : std::uint8_t { Diffuse, Metal, Dielectric, Emissive };
    static constexpr int kKindCount = static_cast<int>(Kind::Emissive) + 1;
    Kind kind = Kind::Diffuse;
    std::int32_t texture_id =
        0;            ///< albedo in [0, 1] (Diffuse, Metal), radiance in [0, 1e6] (Emissive); unused by Dielectric
    double fuzz = 0;  ///< Metal: radius in [0, 1] of the sphere added to the mirrored direction
    double ior = 1;   ///< Dielectric: index of refraction inside over outside, in [0.1, 10]
    /// Emissive: what the radiance of its texture is multiplied by, > 0; the product is in [0, 1e6].
    double strength = 1;
    bool front_only = false;  ///< Emissive: it shines from its outward side, and its other side is black
};

/// A sphere whose centre moves on a straight line: center0 at time 0, center1 at time 1 (equal for a still one).
struct Sphere {
    Vector3d center0{0, 0, 0};
    Vector3d center1{0, 0, 0};
    double radius = 1;  ///< > 0
    std::int32_t material_id = 0;
};

/// A parallelogram: corner + s edge_u + t edge_v with s, t in [0, 1]; (s, t) are its texture coordinates.
struct Quad {
    Vector3d corner{0, 0, 0};
    Vector3d edge_u{1, 0, 0};
    Vector3d edge_v{0, 1, 0};  ///< not parallel to edge_u; the outward side is that of edge_u x edge_v
    std::int32_t material_id = 0;
};

/// An infinite plane; its texture coordinates are scene units along two perpendicular directions within it.
struct Plane {
    Vector3d point{0, 0, 0};
    Vector3d normal{0, 1, 0};  ///< any length > 0
    std::int32_t material_id = 0;
    /// How many of the scene's quads are listed before it, by default all: of shapes that coincide the first counts.
    std::int64_t quads_before = std::numeric_limits<std::int64_t>::max();
};

/// A mesh of triangles, placed. A triangle's outward side is the one from which its vertices are seen counterclockwise.
/// It is smooth where its vertices have normals.
struct MeshShape {
    std::shared_ptr<const Mesh> mesh;  ///< shared, since scenes are copied
    /// Takes a vertex to its place: a matrix, not singular, and in the last column what is added.
    Eigen::Matrix<double, 3, 4> transform = Eigen::Matrix<double, 3, 4>::Identity();
    std::int32_t material_id = 0;
    /// Its triangles are in memory once, whatever the number of instances of the mesh, and placed when rays meet them,
    /// in the precision of the render. What shines is never an instance: each of its triangles is a light.
    bool is_instance = false;

    [[nodiscard]] Vector3d placed(const std::array<float, 3>& position) const {
        const Vector3d p(position[0], position[1], position[2]);
        return transform.leftCols<3>() * p + transform.col(3);
    }
    /// Takes a normal to its place, but for its length: outward stays outward.
    [[nodiscard]] Eigen::Matrix3d normal_transform() const { return transform.leftCols<3>().inverse().transpose(); }
    /// Then the order of vertices is seen the other way round.
    [[nodiscard]] bool is_mirrored() const { return transform.leftCols<3>().determinant() < 0; }
};

/// The most triangles of instances, with all other shapes.
inline constexpr std::int64_t kMaxShownTriangles = std::int64_t{1} << 29;

/// A primitive's id counts through all shapes in this order: spheres, quads, planes, the triangles of meshes that are
/// no instances, and those of instances.
struct Scene {
    std::string name;          ///< file name without folder and extension, as UTF-8
    std::string description;   ///< what the scene is for and where it comes from; not empty
    std::int64_t width = 400;  ///< default image size in pixels, each in [1, 65536]
    std::int64_t height = 225;
    CameraDescription camera;
    Background background;
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Sphere> spheres;
    std::vector<Quad> quads;
    std::vector<Plane> planes;
    std::vector<MeshShape> meshes;

    [[nodiscard]] bool is_instance(const MeshShape& shape) const {
        const Material& material = materials[static_cast<std::size_t>(shape.material_id)];
        return shape.is_instance && material.kind != Material::Kind::Emissive;
    }
};

}  // namespace raypool
