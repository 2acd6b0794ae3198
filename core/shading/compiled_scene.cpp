#include "core/shading/compiled_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/geometry/shape_bounds.h"
#include "core/shading/mesh_rows.h"
#include "core/shading/shape_blocks.h"

namespace raypool {

namespace {

enum class Shape : std::uint8_t { Sphere, Quad, Plane, Mesh };

ImageRepeat image_repeat(Texture::Wrap wrap, Shape shape) {
    if (wrap == Texture::Wrap::Clamp) return {};
    if (shape == Shape::Sphere) return {.u = true, .v = false};
    const bool repeats = wrap == Texture::Wrap::Repeat || shape == Shape::Plane || shape == Shape::Mesh;
    return {.u = repeats, .v = repeats};
}

template <class Scalar>
class Compiler {
  public:
    Compiler(const Scene& scene, const Coincidence& coincidence)
        : scene_(scene),
          coincidence_(coincidence),
          features_(scene_features(scene)),
          max_radiance_(scene.background.brightest()) {}

    CompiledScene<Scalar> compile() {
        check_size();
        add_textures();
        add_surfaces();
        add_meshes();
        add_blocks(scene_, coincidence_, mesh_rows_.objects(), out_);
        if (features_.lights) out_.lights = light_table<Scalar>(scene_, coincidence_.is_hidden);
        features_.lights = !out_.lights.rows.empty();
        out_.environment = environment_tables<Scalar>(scene_.background, out_.lights.environment_chance);
        SceneTables<Scalar>::for_each_table(out_, [](auto& table) { table.shrink_to_fit(); });

        CompiledScene<Scalar> compiled(std::move(out_));
        compiled.features = features_;
        compiled.width = scene_.width;
        compiled.height = scene_.height;
        compiled.first_triangle = static_cast<std::int32_t>(coincidence_.is_hidden.size());
        compiled.first_instanced = first_instanced_;
        compiled.end_instanced = end_instanced_;
        compiled.camera = make_camera<Scalar>(scene_.camera, scene_.width, scene_.height);
        const Vector3d middle = 0.5 * (scene_.background.bottom + scene_.background.top);
        const Vector3d slope = 0.5 * (scene_.background.top - scene_.background.bottom);
        compiled.sky = {middle.cast<Scalar>(), slope.cast<Scalar>()};
        if (const Image* image = scene_.background.image.get()) {
            compiled.environment.width = static_cast<std::int32_t>(image->width);
            compiled.environment.height = static_cast<std::int32_t>(image->height);
            const double turns = scene_.background.rotation_degrees / 360;
            compiled.environment.rotation = static_cast<Scalar>(turns - std::floor(turns));
        }
        compiled.max_radiance = max_radiance_;
        compiled.max_albedo = max_albedo_;
        compiled.max_sampled_albedo = max_sampled_albedo_;
        return compiled;
    }

  private:
    void check_size() const {
        constexpr std::int64_t kMostPixels = std::int64_t{1} << 32U;  // a ray record names its pixel in 32 bits
        if (scene_.width * scene_.height > kMostPixels)
            throw InputError(
                fmt::format("image of {} x {}: must have at most 2^32 pixels", scene_.width, scene_.height));
        static_assert(kMostBoxes <= std::size_t{1} << PlanarMark<Scalar>::kGroupBits, "a group is an id");
        std::size_t count = scene_.spheres.size() + scene_.quads.size() + scene_.planes.size();
        std::size_t vertices = 0;
        std::size_t instances = 0;
        std::size_t instanced = 0;  // triangles
        std::set<std::pair<const Mesh*, bool>> objects;
        for (const MeshShape& shape : scene_.meshes) {
            const Mesh& mesh = *shape.mesh;
            if (scene_.is_instance(shape)) {
                ++instances;
                instanced += mesh.triangles.size();
                if (!objects.emplace(&mesh, shape.is_mirrored()).second) continue;
            }
            count += mesh.triangles.size();
            vertices += mesh.positions.size();
        }
        if (vertices > 3 * kMostBoxes)
            throw InputError(fmt::format("meshes of {} vertices: must have at most {}", vertices, 3 * kMostBoxes));
        if (count > kMostBoxes)
            throw InputError(fmt::format("scene of {} shapes: must have at most {}", count, kMostBoxes));
        if (instances > kMostBoxes)
            throw InputError(fmt::format("scene of {} instances: must have at most {}", instances, kMostBoxes));
        constexpr std::size_t kMostIds = std::size_t{1} << PlanarMark<Scalar>::kGroupBits;
        static_assert(kMostIds == kMaxShownTriangles);
        if (count + instanced > kMostIds)
            throw InputError(
                fmt::format("instances of {} triangles: a scene must have at most {} shapes", instanced, kMostIds));
        constexpr std::size_t kMostTextures = SurfaceCode<int>::kMostTextures;
        if (scene_.textures.size() > kMostTextures)
            throw InputError(
                fmt::format("scene of {} textures: must have at most {}", scene_.textures.size(), kMostTextures));
    }

    void add_textures() {
        using Row = TextureRow<Scalar>;
        for (const Texture& texture : scene_.textures) {
            Row row{};
            for (int i = 0; i < 3; ++i) {
                row.value[Row::kOdd + i] = static_cast<Scalar>(texture.odd[i]);
                row.value[Row::kOffset + i] = static_cast<Scalar>(texture.offset[i]);
            }
            const double scale = 1 / texture.scale;
            row.value[Row::kScaleHigh] = static_cast<Scalar>(scale);
            row.value[Row::kScaleLow] = static_cast<Scalar>(scale - static_cast<double>(static_cast<Scalar>(scale)));
            out_.textures.push_back(row);
        }
        add_images();
    }

    void add_images() {
        std::size_t count = 0;
        for (const Texture& texture : scene_.textures)
            if (texture.image) count += texture.image->rgb.size() / 3 * 4;
        out_.texels.reserve(count);
        for (const Texture& texture : scene_.textures) {
            ImagePlace place;
            if (texture.image) {
                place = {static_cast<std::int64_t>(out_.texels.size()), static_cast<std::int32_t>(texture.image->width),
                         static_cast<std::int32_t>(texture.image->height)};
                for (std::size_t i = 0; i < texture.image->rgb.size(); i += 3)
                    for (const float channel :
                         {texture.image->rgb[i], texture.image->rgb[i + 1], texture.image->rgb[i + 2], 0.0F})
                        out_.texels.push_back(channel);
            }
            out_.images.push_back(place);
        }
    }

    SurfaceRow<Scalar> surface_row(int material_id, Shape shape) {
        using Row = SurfaceRow<Scalar>;
        const Material& material = scene_.materials[material_id];
        Row row{};
        const auto set_code = [&](int texture, int texture_row) {
            row.value[Row::kCode] =
                of_bits<Scalar>(SurfaceCode<Int<Scalar>>::make(static_cast<int>(material.kind), texture, texture_row));
        };
        set_code(0, 0);
        if (material.kind == Material::Kind::Dielectric) {
            row.value[Row::kParameter] = static_cast<Scalar>(material.ior);
            max_albedo_ = 1;
            return row;
        }
        const Texture& texture = scene_.textures[material.texture_id];
        const bool is_emitter = material.kind == Material::Kind::Emissive;
        row.value[Row::kParameter] =
            static_cast<Scalar>(is_emitter ? (material.front_only ? -1 : 1) * material.strength : material.fuzz);
        for (int i = 0; i < 3; ++i) row.value[Row::kColour + i] = static_cast<Scalar>(texture.even[i]);
        const int repeat = texture.image ? image_repeat(texture.wrap, shape).number() : 0;
        set_code(static_cast<int>(texture.kind) + repeat, material.texture_id);
        double& most = is_emitter ? max_radiance_ : max_albedo_;
        most = std::max(most, texture.brightest() * (is_emitter ? material.strength : 1));
        if (material.kind == Material::Kind::Diffuse || (material.kind == Material::Kind::Metal && material.fuzz > 0))
            max_sampled_albedo_ = std::max(max_sampled_albedo_, texture.brightest());
        return row;
    }

    void add_surfaces() {
        using Row = SurfaceRow<Scalar>;
        for (const Sphere& sphere : scene_.spheres) {
            Row row = surface_row(sphere.material_id, Shape::Sphere);
            for (int i = 0; i < 3; ++i) {
                row.value[Row::kCenter + i] = static_cast<Scalar>(sphere.center0[i]);
                if (features_.motion)  // or all rays are of time 0
                    row.value[Row::kMotion + i] = static_cast<Scalar>(sphere.center1[i] - sphere.center0[i]);
            }
            row.value[Row::kRadius] = static_cast<Scalar>(sphere.radius);
            out_.surfaces.push_back(row);
        }
        for (const Quad& quad : scene_.quads) add_planar_surface(planar_shape(quad), Shape::Quad);
        for (const Plane& plane : scene_.planes) add_planar_surface(planar_shape(plane), Shape::Plane);
    }

    void add_planar_surface(const PlanarShape& shape, Shape kind) {
        SurfaceRow<Scalar> surface = surface_row(shape.material_id, kind);
        PlanarRow<Scalar> planar{};
        const Coincidence::Planar& met = coincidence_.planars[out_.planars.size()];
        surface.value[SurfaceRow<Scalar>::kRadius] = PlanarMark<Scalar>::make(static_cast<Int<Scalar>>(met.group));
        for (int i = 0; i < 3; ++i) {
            surface.value[SurfaceRow<Scalar>::kCenter + i] = static_cast<Scalar>(met.normal[i]);
            surface.value[SurfaceRow<Scalar>::kMotion + i] = static_cast<Scalar>(met.point[i]);
            planar.value[PlanarRow<Scalar>::kCorner + i] = static_cast<Scalar>(shape.corner[i]);
            planar.value[PlanarRow<Scalar>::kDualU + i] = static_cast<Scalar>(shape.dual_u[i]);
            planar.value[PlanarRow<Scalar>::kDualV + i] = static_cast<Scalar>(shape.dual_v[i]);
        }
        out_.surfaces.push_back(surface);
        out_.planars.push_back(planar);
    }

    void add_meshes() {
        const auto add_all = [&](bool are_instances, auto add) {
            for (const MeshShape& shape : scene_.meshes) {
                if (scene_.is_instance(shape) != are_instances || shape.mesh->triangles.empty()) continue;
                out_.surfaces.push_back(surface_row(shape.material_id, Shape::Mesh));
                add(shape, out_.surfaces.size() - 1);
            }
        };
        add_all(false, [&](const MeshShape& shape, std::size_t surface) { mesh_rows_.add(shape, surface); });
        first_instanced_ = end_instanced_ =
            static_cast<std::int32_t>(coincidence_.is_hidden.size() + out_.triangles.size());
        add_all(true, [&](const MeshShape& shape, std::size_t surface) {
            mesh_rows_.add_instance(shape, surface, end_instanced_);
            end_instanced_ += static_cast<std::int32_t>(shape.mesh->triangles.size());
        });
        mesh_rows_.finish();
    }

    const Scene& scene_;
    const Coincidence& coincidence_;
    Features features_;
    double max_radiance_;
    double max_albedo_ = 0;
    double max_sampled_albedo_ = 0;
    SceneTables<Scalar> out_;
    MeshRows<Scalar> mesh_rows_{out_};
    std::int32_t first_instanced_ = 0;
    std::int32_t end_instanced_ = 0;
};

}  // namespace

template <class Scalar>
std::size_t CompiledScene<Scalar>::bytes() const {
    std::size_t bytes = sizeof(*this) + sizeof(*tables_);
    SceneTables<Scalar>::for_each_table(*tables_,
                                        [&](const auto& table) { bytes += table.capacity() * sizeof(table[0]); });
    return bytes;
}

template <class Scalar>
CompiledScene<Scalar> compile(const Scene& scene, const Coincidence& coincidence) {
    return Compiler<Scalar>(scene, coincidence).compile();
}

template <class Scalar>
CompiledScene<Scalar> compile(const Scene& scene) {
    return compile<Scalar>(scene, find_coincidence<Scalar>(scene));
}

template class CompiledScene<float>;
template class CompiledScene<double>;
template CompiledScene<float> compile(const Scene&);
template CompiledScene<double> compile(const Scene&);
template CompiledScene<float> compile(const Scene&, const Coincidence&);
template CompiledScene<double> compile(const Scene&, const Coincidence&);

}  // namespace raypool
