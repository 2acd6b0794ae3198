#include "core/shading/compiled_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/geometry/large_boxes.h"
#include "core/geometry/node_motion.h"
#include "core/geometry/shape_bounds.h"

namespace raypool {

namespace {

/// Shapes that are worth more than one thread.
constexpr std::size_t kFewestShapes = 16384;

enum class Shape : std::uint8_t { Sphere, Quad, Plane };

ImageRepeat image_repeat(Texture::Wrap wrap, Shape shape) {
    if (wrap == Texture::Wrap::Clamp) return {};
    if (shape == Shape::Sphere) return {.u = true, .v = false};
    const bool repeats = wrap == Texture::Wrap::Repeat || shape == Shape::Plane;
    return {.u = repeats, .v = repeats};
}

template <class Scalar>
class Compiler {
  public:
    Compiler(const Scene& scene, const Coincidence& coincidence)
        : scene_(scene),
          coincidence_(coincidence),
          features_(scene_features(scene)),
          max_radiance_(std::max(scene.background.bottom.maxCoeff(), scene.background.top.maxCoeff())) {}

    CompiledScene<Scalar> compile() {
        check_size();
        add_textures();
        add_surfaces();
        add_spheres();
        add_planars();
        SceneTables<Scalar>::for_each_table(out_, [](auto& table) { table.shrink_to_fit(); });

        CompiledScene<Scalar> compiled(std::move(out_));
        compiled.features = features_;
        compiled.width = scene_.width;
        compiled.height = scene_.height;
        compiled.camera = make_camera<Scalar>(scene_.camera, scene_.width, scene_.height);
        const Vector3d middle = 0.5 * (scene_.background.bottom + scene_.background.top);
        const Vector3d slope = 0.5 * (scene_.background.top - scene_.background.bottom);
        compiled.sky = {middle.cast<Scalar>(), slope.cast<Scalar>()};
        compiled.max_radiance = max_radiance_;
        compiled.max_albedo = max_albedo_;
        return compiled;
    }

  private:
    using Ids = std::vector<std::uint32_t>;
    static constexpr int kWidth = kTreeWidth<Scalar>;

    void check_size() const {
        constexpr std::int64_t kMostPixels = std::int64_t{1} << 32U;  // a ray record names its pixel in 32 bits
        if (scene_.width * scene_.height > kMostPixels)
            throw InputError(
                fmt::format("image of {} x {}: must have at most 2^32 pixels", scene_.width, scene_.height));
        static_assert(kMostBoxes <= std::size_t{1} << PlanarMark<Scalar>::kGroupBits, "a group is an id");
        const std::size_t count = scene_.spheres.size() + scene_.quads.size() + scene_.planes.size();
        if (count > kMostBoxes)
            throw InputError(fmt::format("scene of {} shapes: must have at most {}", count, kMostBoxes));
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
        out_.texels.reserve(count);  // views point into it
        for (const Texture& texture : scene_.textures) {
            ImageView<Scalar> view;
            if (texture.image) {
                view = {out_.texels.data() + out_.texels.size(), static_cast<std::int32_t>(texture.image->width),
                        static_cast<std::int32_t>(texture.image->height)};
                for (std::size_t i = 0; i < texture.image->rgb.size(); i += 3)
                    for (const float channel :
                         {texture.image->rgb[i], texture.image->rgb[i + 1], texture.image->rgb[i + 2], 0.0F})
                        out_.texels.push_back(channel);
            }
            out_.images.push_back(view);
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
        row.value[Row::kParameter] = static_cast<Scalar>(material.fuzz);
        for (int i = 0; i < 3; ++i) row.value[Row::kColour + i] = static_cast<Scalar>(texture.even[i]);
        const int repeat = texture.image ? image_repeat(texture.wrap, shape).number() : 0;
        set_code(static_cast<int>(texture.kind) + repeat, material.texture_id);
        const double brightest = texture.image ? 1 : std::max(texture.even.maxCoeff(), texture.odd.maxCoeff());
        double& most = material.kind == Material::Kind::Emissive ? max_radiance_ : max_albedo_;
        most = std::max(most, brightest);
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

    void add_spheres() {
        Ids ids = shown_ids(0, scene_.spheres.size());
        const auto boxes_of = [&](const Ids& of) {
            return boxes_by_id(
                of, [&](std::uint32_t id) { return sphere_box<Scalar>(scene_.spheres[id], features_.motion ? 1 : 0); });
        };
        std::vector<Box> boxes = boxes_of(ids);
        Ids large = large_boxes(boxes, kWidth);
        if (!large.empty()) {
            for (std::uint32_t& place : large) place = ids[place];
            out_.large_spheres.push_back(sphere_block(large));
            std::erase_if(ids,
                          [&](std::uint32_t id) { return std::find(large.begin(), large.end(), id) != large.end(); });
            boxes = boxes_of(ids);
        }
        out_.sphere_tree = block_tree<SphereBlock<Scalar, kWidth>>(
            boxes, ids, [&](std::span<const std::uint32_t> in_leaf) { return sphere_block(in_leaf); });
        if (!features_.motion) return;
        for (int axis = 0; axis < 3; ++axis) out_.sphere_tree.motion[axis] = node_motion(out_.sphere_tree, axis);
    }

    void add_planars() {
        const std::size_t first_plane = scene_.spheres.size() + scene_.quads.size();
        const Ids ids = shown_ids(scene_.spheres.size(), first_plane);
        const auto box_of = [&](std::uint32_t id) {
            return quad_box<Scalar>(scene_.quads[id - scene_.spheres.size()]);
        };
        out_.quad_tree = block_tree<PlanarBlock<Scalar, kWidth>>(
            boxes_by_id(ids, box_of), ids, [&](std::span<const std::uint32_t> in_leaf) {
                std::array<Box, kWidth> leaf_boxes;
                std::transform(in_leaf.begin(), in_leaf.end(), leaf_boxes.begin(), box_of);
                return planar_block(in_leaf, leaf_boxes);
            });
        const Ids planes = shown_ids(first_plane, first_plane + scene_.planes.size());
        for (std::size_t i = 0; i < planes.size(); i += kWidth) {
            const std::span block = std::span(planes).subspan(i, std::min<std::size_t>(kWidth, planes.size() - i));
            out_.planes.push_back(planar_block(block, std::array<Box, kWidth>{}));
        }
    }

    /// Of the ids in [first, end), those of shapes that no earlier one hides.
    [[nodiscard]] Ids shown_ids(std::size_t first, std::size_t end) const {
        Ids ids;
        for (std::size_t id = first; id < end; ++id)
            if (!coincidence_.is_hidden[id]) ids.push_back(static_cast<std::uint32_t>(id));
        return ids;
    }

    SphereBlock<Scalar, kWidth> sphere_block(std::span<const std::uint32_t> ids) const {
        SphereBlock<Scalar, kWidth> block{};
        std::fill_n(block.radius, kWidth, std::numeric_limits<Scalar>::quiet_NaN());
        std::fill_n(block.id, kWidth, kNoPrimitive);
        for (std::size_t lane = 0; lane < ids.size(); ++lane) {
            using Row = SurfaceRow<Scalar>;
            const Row& row = out_.surfaces[ids[lane]];
            for (int i = 0; i < 3; ++i) {
                block.center[i][lane] = row.value[Row::kCenter + i];
                block.motion[i][lane] = row.value[Row::kMotion + i];
            }
            block.radius[lane] = row.value[Row::kRadius];
            block.padded_radius[lane] = padded_radius<Scalar>(scene_.spheres[ids[lane]]);
            block.id[lane] = static_cast<std::int32_t>(ids[lane]);
        }
        return block;
    }

    PlanarBlock<Scalar, kWidth> planar_block(std::span<const std::uint32_t> ids,
                                             const std::array<Box, kWidth>& boxes) const {
        PlanarBlock<Scalar, kWidth> block{};
        for (auto& component : block.normal) std::fill_n(component, kWidth, std::numeric_limits<Scalar>::quiet_NaN());
        std::fill_n(block.id, kWidth, kNoPrimitive);
        for (std::size_t lane = 0; lane < ids.size(); ++lane) {
            const SurfaceRow<Scalar>& surface = out_.surfaces[ids[lane]];
            const PlanarRow<Scalar>& planar = out_.planars[ids[lane] - scene_.spheres.size()];
            for (int i = 0; i < 3; ++i) {
                block.point[i][lane] = surface.value[SurfaceRow<Scalar>::kMotion + i];
                block.corner[i][lane] = planar.value[PlanarRow<Scalar>::kCorner + i];
                block.normal[i][lane] = surface.value[SurfaceRow<Scalar>::kCenter + i];
                block.dual_u[i][lane] = planar.value[PlanarRow<Scalar>::kDualU + i];
                block.dual_v[i][lane] = planar.value[PlanarRow<Scalar>::kDualV + i];
                block.low[i][lane] = static_cast<Scalar>(boxes[lane].low[i]);
                block.high[i][lane] = static_cast<Scalar>(boxes[lane].high[i]);
            }
            block.group[lane] =
                static_cast<std::int32_t>(PlanarMark<Scalar>::group(surface.value[SurfaceRow<Scalar>::kRadius], 0));
            block.id[lane] = static_cast<std::int32_t>(ids[lane]);
        }
        return block;
    }

    template <class BoxOf>
    static std::vector<Box> boxes_by_id(const Ids& ids, BoxOf box_of) {
        std::vector<Box> boxes(ids.size());
#pragma omp parallel for schedule(static) if (ids.size() > kFewestShapes)
        for (std::size_t i = 0; i < ids.size(); ++i) boxes[i] = box_of(ids[i]);
        return boxes;
    }

    /// make_block(ids of a leaf) throws nothing.
    template <class Block, class MakeBlock>
    BlockTree<Block, Scalar, kWidth> block_tree(const std::vector<Box>& boxes, const Ids& ids,
                                                MakeBlock make_block) const {
        WideBvh<Scalar, kWidth> bvh = collapse<Scalar, kWidth>(build_binary_bvh(boxes, kWidth));
        BlockTree<Block, Scalar, kWidth> tree;
        tree.blocks.resize(bvh.leaves.size());
#pragma omp parallel for schedule(static) if (ids.size() > kFewestShapes)
        for (std::size_t i = 0; i < bvh.leaves.size(); ++i) {
            const auto& leaf = bvh.leaves[i];
            std::array<std::uint32_t, kWidth> in_leaf;
            for (std::uint32_t k = 0; k < leaf.count; ++k) in_leaf[k] = ids[bvh.order[leaf.first + k]];
            tree.blocks[i] = make_block(std::span(in_leaf).first(leaf.count));
        }
        tree.nodes = std::move(bvh.nodes);
        tree.depth = bvh.depth;
        return tree;
    }

    const Scene& scene_;
    const Coincidence& coincidence_;
    Features features_;
    double max_radiance_;
    double max_albedo_ = 0;
    SceneTables<Scalar> out_;
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
