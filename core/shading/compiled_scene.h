/// The scene as the kernels read it: immutable tables in the precision of the render.
///
/// Made by compile(); shared by all threads without locks. Engines and kernels see nothing of the description in
/// scene.h. A primitive's id counts spheres, then quads, then planes, then triangles, and last those of instances.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/coincidence.h"
#include "core/geometry/shape_tables.h"
#include "core/scene/features.h"
#include "core/scene/scene.h"
#include "core/shading/camera.h"
#include "core/shading/environment.h"
#include "core/shading/light_table.h"
#include "core/shading/textures.h"

namespace raypool {

/// What shading needs of a primitive and its material: a row of 12 scalars, found by the primitive's id.
template <class Scalar>
struct alignas(4 * sizeof(Scalar)) SurfaceRow {
    enum Column {
        kCenter = 0,  ///< of a sphere at time 0, three; or the unit normal of a quad or plane
        kRadius = 3,  ///< of a sphere; of a quad or plane the PlanarMark of the group that a ray which leaves it leaves
        kMotion = 4,  ///< of the centre from time 0 to 1, three; or a point of the plane of a quad or plane
        kParameter =
            7,  ///< fuzz of metal, index of refraction of glass, strength of an emitter, < 0 if only the front shines
        kColour = 8,  ///< three: albedo or radiance; of a checker the even colour
        kCode = 11,   ///< the bits of a SurfaceCode
        kColumns = 12
    };
    Scalar value[kColumns];
};

/// A group's id in the bits of a number of at most -2, which no radius is; and back. Shapes in one plane are a group
/// (coincidence.h).
template <class Real>
struct PlanarMark {
    static constexpr int kGroupBits = 29;  ///< with so many bits free, a float stays finite and at most -2
    static constexpr ScalarOf<Int<Real>> kSign = std::bit_cast<ScalarOf<Int<Real>>>(ScalarOf<Real>(-2));

    RAYPOOL_INLINE static Real make(const Int<Real>& group) { return of_bits<Real>(group | Int<Real>(kSign)); }
    /// Of a row whose kRadius is `radius`: the group of a quad or plane, and `sphere_id` of a sphere. A single ray gets
    /// it without a branch, which it would often take by surprise. (clang 14 cannot shift registers of 64-bit integers
    /// by 63.)
    RAYPOOL_INLINE static Int<Real> group(const Real& radius, const Int<Real>& sphere_id) {
        const Int<Real> bits = bits_of<Real>(radius);
        const Int<Real> group = bits & Int<Real>((1 << kGroupBits) - 1);
        if constexpr (Simd<Real>) {
            return select(radius < Real(0), group, sphere_id);
        } else {
            const Int<Real> ones_if_planar = bits >> (8 * static_cast<int>(sizeof(Real)) - 1);
            return (group & ones_if_planar) | (sphere_id & ~ones_if_planar);
        }
    }
};

/// Material and texture in one whole number: Material::Kind, Texture::Kind (of an image its number plus
/// ImageRepeat's), and the row of the texture.
template <class Integer>
struct SurfaceCode {
    static constexpr int kMaterialBits = 3;
    static_assert(Material::kKindCount <= 1 << kMaterialBits);
    static constexpr int kTextureBits = 3;
    static constexpr std::size_t kMostTextures = std::size_t{1} << (31 - kMaterialBits - kTextureBits);

    Integer code;
    [[nodiscard]] RAYPOOL_INLINE Integer material() const { return code & Integer((1 << kMaterialBits) - 1); }
    [[nodiscard]] RAYPOOL_INLINE Integer texture() const {
        return code >> kMaterialBits & Integer((1 << kTextureBits) - 1);
    }
    [[nodiscard]] RAYPOOL_INLINE Integer texture_row() const { return code >> (kMaterialBits + kTextureBits); }
    static constexpr Integer make(Integer material, Integer texture, Integer texture_row) {
        return material + (texture << kMaterialBits) + (texture_row << (kMaterialBits + kTextureBits));
    }
};

template <class Scalar>
struct alignas(4 * sizeof(Scalar)) TextureRow {
    enum Column { kOdd = 0, kScaleHigh = 3, kOffset = 4, kScaleLow = 7, kColumns = 8 };
    Scalar value[kColumns];  ///< of a checker: the odd colour (3), 1 / edge in two parts, the offset (3)
};

/// Surface coordinates of quads and planes: (p - corner) . dual_u and (p - corner) . dual_v.
template <class Scalar>
struct alignas(4 * sizeof(Scalar)) PlanarRow {
    enum Column { kCorner = 0, kDualU = 4, kDualV = 8, kColumns = 12 };
    Scalar value[kColumns];
};

/// Which vertices a triangle has, and the row of its mesh among the surfaces.
template <class Scalar>
struct alignas(4 * sizeof(Scalar)) TriangleRow {
    enum Column { kVertex = 0, kSurface = 3, kColumns = 4 };  ///< three rows of vertices
    Scalar value[kColumns];                                   ///< the bits of whole numbers
};
template <class Scalar>
struct alignas(4 * sizeof(Scalar)) VertexRow {
    enum Column { kPosition = 0, kNormal = 3, kColumns = 4 };  ///< three; the bits of the normal's number, -1 for none
    Scalar value[kColumns];
};

template <class Scalar>
struct Sky {
    Vec3<Scalar> middle;  ///< radiance at the horizon, ...
    Vec3<Scalar> slope;   ///< ... plus this times the direction's y
};

/// What compile() makes of shapes, materials and textures.
template <class Scalar>
struct SceneTables : ShapeTables<Scalar> {
    std::vector<SurfaceRow<Scalar>> surfaces;    ///< by primitive id, less triangles; and one of each mesh
    std::vector<TextureRow<Scalar>> textures;    ///< by texture id
    std::vector<PlanarRow<Scalar>> planars;      ///< of quads and planes, by id less first_planar()
    std::vector<TriangleRow<Scalar>> triangles;  ///< by id less first_triangle; and behind them those of objects
    std::vector<VertexRow<Scalar>> vertices;     ///< where they stand; of objects in their own space
    std::vector<Scalar> instance_first_ids;      ///< the bits of whole numbers, in order
    /// Unit, three scalars each, and one scalar behind the last; empty where no mesh has any.
    std::vector<Scalar> vertex_normals;
    std::vector<Scalar> vertex_uv;   ///< two of each vertex; empty where no mesh has any
    std::vector<ImagePlace> images;  ///< by texture id, beside `textures`
    std::vector<Scalar> texels;
    LightTable<Scalar> lights;
    EnvironmentTables<Scalar> environment;

    /// Calls visit(std::vector&) for every table: the one list of them.
    template <class Self, class Visit>
    static void for_each_table(Self& self, Visit visit) {
        visit(self.surfaces);
        visit(self.textures);
        visit(self.planars);
        visit(self.triangles);
        visit(self.vertices);
        visit(self.instance_first_ids);
        visit(self.vertex_normals);
        visit(self.vertex_uv);
        visit(self.images);
        visit(self.texels);
        visit(self.lights.rows);
        visit(self.lights.weights);
        visit(self.environment.texels);
        visit(self.environment.rows);
        visit(self.environment.entries);
        ShapeTables<Scalar>::for_each_table(self, visit);
    }
};

/// All that a kernel may ask of a scene: a plain value whose pointers lead into tables.
template <class Scalar>
struct SceneView : ShapeView<Scalar> {
    Features features;
    std::int64_t width = 0;  ///< of the image, in pixels
    std::int64_t height = 0;
    std::int32_t first_triangle = 0;   ///< its id: how many primitives are none
    std::int32_t first_instanced = 0;  ///< the id of the first triangle of the first instance
    std::int32_t end_instanced = 0;    ///< the id behind that of the last of the last
    Camera<Scalar> camera;
    Sky<Scalar> sky;
    EnvironmentView<Scalar> environment;  ///< in place of the sky if it has texels
    double max_radiance = 0;              ///< no path carries more to the image in any channel
    double max_albedo = 0;                ///< no hit leaves a path more of its throughput in any channel
    double max_sampled_albedo = 0;        ///< no hit does at which lights may be sampled

    std::span<const SurfaceRow<Scalar>> surfaces;
    std::span<const TextureRow<Scalar>> textures;
    std::span<const PlanarRow<Scalar>> planars;
    std::span<const TriangleRow<Scalar>> triangles;
    std::span<const VertexRow<Scalar>> vertices;
    std::span<const Scalar> instance_first_ids;
    std::span<const Scalar> vertex_normals;
    std::span<const Scalar> vertex_uv;
    std::span<const ImagePlace> images;
    std::span<const Scalar> texels;
    std::span<const LightRow<Scalar>> lights;
    std::span<const Scalar> light_weights;

    /// Calls visit(std::span&) for every table that is seen, in the order of SceneTables::for_each_table().
    template <class Self, class Visit>
    static void for_each_span(Self& self, Visit visit) {
        visit(self.surfaces);
        visit(self.textures);
        visit(self.planars);
        visit(self.triangles);
        visit(self.vertices);
        visit(self.instance_first_ids);
        visit(self.vertex_normals);
        visit(self.vertex_uv);
        visit(self.images);
        visit(self.texels);
        visit(self.lights);
        visit(self.light_weights);
        visit(self.environment.texels);
        visit(self.environment.rows);
        visit(self.environment.entries);
        ShapeView<Scalar>::for_each_span(self, visit);
    }

    /// Radiance that a limit of depth cuts off a pixel, on average over its paths: at most this in any channel.
    [[nodiscard]] double truncation_bound(std::int32_t depth) const {
        return max_radiance * std::pow(max_albedo, depth);
    }

    /// The id of the first quad or plane.
    [[nodiscard]] RAYPOOL_HOST_DEVICE std::int32_t first_planar() const {
        return first_triangle - static_cast<std::int32_t>(planars.size());
    }
    [[nodiscard]] std::int64_t pixel_count() const { return width * height; }
};

/// The instance of triangles that have one, among those of the scene's tree.
template <class Real>
RAYPOOL_INLINE Int<Real> instance_of(const SceneView<ScalarOf<Real>>& scene, const Int<Real>& primitive_id) {
    const auto count = static_cast<std::int32_t>(scene.instance_first_ids.size());
    Int<Real> found(0);
    for (auto step = static_cast<std::int32_t>(std::bit_floor(static_cast<std::uint32_t>(count))); step > 0;
         step /= 2) {
        const Int<Real> next = found + Int<Real>(step);
        const Mask<Real> is_there = as_mask<Real>(next < Int<Real>(count));
        const Real first = detail::gather<Real>(scene.instance_first_ids.data(), select(is_there, next, Int<Real>(0)));
        found = select(is_there && as_mask<Real>(bits_of<Real>(first) <= primitive_id), next, found);
    }
    return found;
}

/// The row of a primitive among the surfaces.
template <class Scalar>
Int<Scalar> surface_of(const SceneView<Scalar>& scene, std::int32_t primitive_id) {
    if (primitive_id < scene.first_triangle) return primitive_id;
    if (primitive_id >= scene.first_instanced) {
        const auto instance = static_cast<std::size_t>(instance_of<Scalar>(scene, primitive_id));
        return scene.instance_tree.blocks[instance].number(InstanceRow<Scalar>::kSurface);
    }
    const auto triangle = static_cast<std::size_t>(primitive_id - scene.first_triangle);
    return bits_of<Scalar>(scene.triangles[triangle].value[TriangleRow<Scalar>::kSurface]);
}

/// A view with the tables that it sees. Copies share them.
template <class Scalar>
class CompiledScene : public SceneView<Scalar> {
  public:
    /// Sees `tables`; all that is no table is still to be set.
    explicit CompiledScene(SceneTables<Scalar>&& tables)
        : tables_(std::make_shared<const SceneTables<Scalar>>(std::move(tables))) {
        static_cast<ShapeView<Scalar>&>(*this) = ShapeView<Scalar>(*tables_);
        this->surfaces = tables_->surfaces;
        this->textures = tables_->textures;
        this->planars = tables_->planars;
        this->triangles = tables_->triangles;
        this->vertices = tables_->vertices;
        this->instance_first_ids = tables_->instance_first_ids;
        this->vertex_normals = tables_->vertex_normals;
        this->vertex_uv = tables_->vertex_uv;
        this->images = tables_->images;
        this->texels = tables_->texels;
        this->lights = tables_->lights.rows;
        this->light_weights = tables_->lights.weights;
        this->environment.texels = tables_->environment.texels;
        this->environment.rows = tables_->environment.rows;
        this->environment.entries = tables_->environment.entries;
    }

    [[nodiscard]] const SceneTables<Scalar>& tables() const { return *tables_; }
    [[nodiscard]] std::size_t bytes() const;  ///< of all tables, with this

  private:
    std::shared_ptr<const SceneTables<Scalar>> tables_;
};

/// Refuses (InputError) an image of more than 2^32 pixels, or more primitives or vertices than ids. Shapes that
/// coincide count once (coincidence.h); one that is hidden keeps its id and its row, and is in no block.
template <class Scalar>
CompiledScene<Scalar> compile(const Scene& scene);
/// The same with what coincides said by the caller.
template <class Scalar>
CompiledScene<Scalar> compile(const Scene& scene, const Coincidence& coincidence);

extern template CompiledScene<float> compile(const Scene&);
extern template CompiledScene<double> compile(const Scene&);
extern template CompiledScene<float> compile(const Scene&, const Coincidence&);
extern template CompiledScene<double> compile(const Scene&, const Coincidence&);

}  // namespace raypool
