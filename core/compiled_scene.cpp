#include "core/compiled_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/error.h"

namespace raypool {

namespace {

/// A sphere is tested up front when its box is more than this part of the box of all smaller ones.
constexpr double kLargeArea = 0.01;

/// Half the edge of a sphere's box: the radius, and room for the rounding of centre + radius and of distances.
template <class Scalar>
Scalar padded_radius(const Sphere& sphere) {
    const double reach = std::max(sphere.center0.cwiseAbs().maxCoeff(), sphere.center1.cwiseAbs().maxCoeff());
    const double epsilon = std::numeric_limits<Scalar>::epsilon();
    return static_cast<Scalar>(sphere.radius * (1 + 8 * epsilon) + 4 * epsilon * (reach + sphere.radius));
}

/// One more ulp on either side: room for the rounding of the union over time.
template <class Scalar>
Box widened(const Box& box) {
    Box wide;
    for (int axis = 0; axis < 3; ++axis) {
        constexpr Scalar kFar = std::numeric_limits<Scalar>::infinity();
        wide.low[axis] = std::nextafter(static_cast<Scalar>(box.low[axis]), -kFar);
        wide.high[axis] = std::nextafter(static_cast<Scalar>(box.high[axis]), kFar);
    }
    return wide;
}

/// The box over all times, exact in Scalar. It holds every box that a kernel makes of center_at(time) -+ padded radius.
template <class Scalar>
Box sphere_box(const Sphere& sphere) {
    const Scalar r = padded_radius<Scalar>(sphere);
    Box box;
    for (const double time : {0.0, 1.0}) {
        for (int axis = 0; axis < 3; ++axis) {
            const Scalar from = static_cast<Scalar>(sphere.center0[axis]);
            const Scalar motion = static_cast<Scalar>(sphere.center1[axis] - sphere.center0[axis]);
            const Scalar center = from + static_cast<Scalar>(time) * motion;
            box.low[axis] = std::min(box.low[axis], static_cast<double>(static_cast<Scalar>(center - r)));
            box.high[axis] = std::max(box.high[axis], static_cast<double>(static_cast<Scalar>(center + r)));
        }
    }
    return widened<Scalar>(box);
}

template <class Scalar>
Box quad_box(const Quad& quad) {
    Box box;
    for (const double s : {0.0, 1.0}) {
        for (const double t : {0.0, 1.0}) {
            const Vector3d corner = quad.corner + s * quad.edge_u + t * quad.edge_v;
            box.extend({corner, corner});
        }
    }
    const double reach = std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
    const double pad = 16 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) * reach;
    return widened<Scalar>({box.low.array() - pad, box.high.array() + pad});
}

struct FlatShape {
    Vector3d corner, normal, dual_u, dual_v;
    int material_id;
};

FlatShape flat_shape(const Quad& quad) {
    const Vector3d n = quad.edge_u.cross(quad.edge_v);
    return {quad.corner, n.normalized(), quad.edge_v.cross(n) / n.squaredNorm(), n.cross(quad.edge_u) / n.squaredNorm(),
            quad.material_id};
}

/// A plane's coordinates run along the image of the x axis (or the z axis, when the plane faces x) within it.
FlatShape flat_shape(const Plane& plane) {
    const Vector3d n = plane.normal.normalized();
    const Vector3d axis = std::abs(n.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitZ();
    const Vector3d u = (axis - axis.dot(n) * n).normalized();
    return {plane.point, n, u, n.cross(u), plane.material_id};
}

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
    explicit Compiler(const Scene& scene) : scene_(scene) {}

    CompiledScene<Scalar> compile() {
        check_size();
        out_.needs = scene_needs(scene_);
        out_.width = scene_.width;
        out_.height = scene_.height;
        out_.camera = make_camera<Scalar>(scene_.camera, scene_.width, scene_.height);
        const Vector3d middle = 0.5 * (scene_.background.bottom + scene_.background.top);
        const Vector3d slope = 0.5 * (scene_.background.top - scene_.background.bottom);
        out_.sky = {middle.cast<Scalar>(), slope.cast<Scalar>()};
        out_.max_radiance = std::max(scene_.background.bottom.maxCoeff(), scene_.background.top.maxCoeff());

        add_textures();
        add_surfaces();
        add_spheres();
        add_flats();
        return std::move(out_);
    }

  private:
    using Ids = std::vector<std::uint32_t>;
    static constexpr int kWidth = kTreeWidth<Scalar>;

    void check_size() const {
        constexpr std::int64_t kMostPixels = std::int64_t{1} << 32U;  // a ray record names its pixel in 32 bits
        if (scene_.width * scene_.height > kMostPixels)
            throw InputError(
                fmt::format("image of {} x {}: must have at most 2^32 pixels", scene_.width, scene_.height));
        constexpr std::size_t kMostPrimitives = std::size_t{1} << 24U;  // whole in a float
        const std::size_t count = scene_.spheres.size() + scene_.quads.size() + scene_.planes.size();
        if (count > kMostPrimitives)
            throw InputError(fmt::format("scene of {} shapes: must have at most {}", count, kMostPrimitives));
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
                view = {out_.texels.data() + out_.texels.size(), texture.image->width, texture.image->height};
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
        row.value[Row::kMaterial] = static_cast<Scalar>(material.kind);
        if (material.kind == Material::Kind::Dielectric) {
            row.value[Row::kParameter] = static_cast<Scalar>(material.ior);
            out_.max_albedo = 1;
            return row;
        }
        const Texture& texture = scene_.textures[material.texture_id];
        row.value[Row::kParameter] = static_cast<Scalar>(material.fuzz);
        for (int i = 0; i < 3; ++i) row.value[Row::kColour + i] = static_cast<Scalar>(texture.even[i]);
        row.value[Row::kTexture] = static_cast<Scalar>(texture.kind);
        if (texture.image) row.value[Row::kTexture] += Scalar(image_repeat(texture.wrap, shape).number());
        row.value[Row::kTextureRow] = static_cast<Scalar>(material.texture_id);
        const double brightest = texture.image ? 1 : std::max(texture.even.maxCoeff(), texture.odd.maxCoeff());
        double& most = material.kind == Material::Kind::Emissive ? out_.max_radiance : out_.max_albedo;
        most = std::max(most, brightest);
        return row;
    }

    void add_surfaces() {
        using Row = SurfaceRow<Scalar>;
        for (const Sphere& sphere : scene_.spheres) {
            Row row = surface_row(sphere.material_id, Shape::Sphere);
            for (int i = 0; i < 3; ++i) {
                row.value[Row::kCenter + i] = static_cast<Scalar>(sphere.center0[i]);
                row.value[Row::kMotion + i] = static_cast<Scalar>(sphere.center1[i] - sphere.center0[i]);
            }
            row.value[Row::kRadius] = static_cast<Scalar>(sphere.radius);
            out_.surfaces.push_back(row);
        }
        for (const Quad& quad : scene_.quads) add_flat_surface(flat_shape(quad), Shape::Quad);
        for (const Plane& plane : scene_.planes) add_flat_surface(flat_shape(plane), Shape::Plane);
    }

    void add_flat_surface(const FlatShape& shape, Shape kind) {
        SurfaceRow<Scalar> surface = surface_row(shape.material_id, kind);
        FlatRow<Scalar> flat{};
        for (int i = 0; i < 3; ++i) {
            surface.value[SurfaceRow<Scalar>::kCenter + i] = static_cast<Scalar>(shape.normal[i]);
            flat.value[FlatRow<Scalar>::kCorner + i] = static_cast<Scalar>(shape.corner[i]);
            flat.value[FlatRow<Scalar>::kDualU + i] = static_cast<Scalar>(shape.dual_u[i]);
            flat.value[FlatRow<Scalar>::kDualV + i] = static_cast<Scalar>(shape.dual_v[i]);
        }
        surface.value[SurfaceRow<Scalar>::kFlatRow] = static_cast<Scalar>(out_.flats.size());
        out_.surfaces.push_back(surface);
        out_.flats.push_back(flat);
    }

    /// Sets aside the spheres that span the scene, largest first, as long as each dwarfs all that are smaller.
    void add_spheres() {
        const std::size_t count = scene_.spheres.size();
        std::vector<Box> box(count);
        std::vector<std::uint32_t> by_area(count);
        std::iota(by_area.begin(), by_area.end(), 0U);
        for (std::size_t i = 0; i < count; ++i) box[i] = sphere_box<Scalar>(scene_.spheres[i]);
        std::stable_sort(by_area.begin(), by_area.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return box[a].area() > box[b].area(); });
        std::vector<double> area_after(count + 1, 0);
        Box after;
        for (std::size_t i = count; i-- > 0;) {
            area_after[i] = after.area();
            after.extend(box[by_area[i]]);
        }
        std::size_t large = 0;
        while (large < std::min<std::size_t>(count, kWidth) &&
               box[by_area[large]].area() > kLargeArea * area_after[large])
            ++large;

        const Ids large_ids(by_area.begin(), by_area.begin() + static_cast<std::ptrdiff_t>(large));
        if (large > 0) out_.large_spheres.push_back(sphere_block<kWidth>(large_ids));

        Ids ids(by_area.begin() + static_cast<std::ptrdiff_t>(large), by_area.end());
        std::sort(ids.begin(), ids.end());
        std::vector<Box> boxes;
        for (const std::uint32_t id : ids) boxes.push_back(box[id]);
        const auto make_tree = [&]<int width>() {
            return block_tree<SphereBlock<Scalar, width>, width>(
                boxes, ids, [&](const Ids& in_leaf) { return sphere_block<width>(in_leaf); });
        };
        out_.sphere_tree = make_tree.template operator()<kWidth>();
        out_.sphere_stream_tree = make_tree.template operator()<kStreamTreeWidth>();
    }

    void add_flats() {
        std::vector<Box> boxes;
        std::vector<std::uint32_t> ids(scene_.quads.size());
        std::iota(ids.begin(), ids.end(), static_cast<std::uint32_t>(scene_.spheres.size()));
        for (const Quad& quad : scene_.quads) boxes.push_back(quad_box<Scalar>(quad));
        const auto make_tree = [&]<int width>() {
            return block_tree<FlatBlock<Scalar, width>, width>(boxes, ids, [&](const Ids& in_leaf) {
                std::vector<Box> leaf_boxes;
                for (const std::uint32_t id : in_leaf) leaf_boxes.push_back(boxes[id - ids.front()]);
                return flat_block<width>(in_leaf, leaf_boxes);
            });
        };
        out_.quad_tree = make_tree.template operator()<kWidth>();
        out_.quad_stream_tree = make_tree.template operator()<kStreamTreeWidth>();
        const auto first_plane = static_cast<std::uint32_t>(scene_.spheres.size() + scene_.quads.size());
        for (std::uint32_t i = 0; i < scene_.planes.size(); i += kWidth) {
            std::vector<std::uint32_t> block;
            for (std::uint32_t k = i; k < std::min<std::size_t>(i + kWidth, scene_.planes.size()); ++k)
                block.push_back(first_plane + k);
            out_.planes.push_back(flat_block<kWidth>(block, std::vector<Box>(block.size())));
        }
    }

    template <int width>
    SphereBlock<Scalar, width> sphere_block(const Ids& ids) const {
        SphereBlock<Scalar, width> block{};
        std::fill_n(block.radius, width, std::numeric_limits<Scalar>::quiet_NaN());
        std::fill_n(block.id, width, kNoPrimitive);
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

    template <int width>
    FlatBlock<Scalar, width> flat_block(const Ids& ids, const std::vector<Box>& boxes) const {
        FlatBlock<Scalar, width> block{};
        for (auto& component : block.normal) std::fill_n(component, width, std::numeric_limits<Scalar>::quiet_NaN());
        std::fill_n(block.id, width, kNoPrimitive);
        for (std::size_t lane = 0; lane < ids.size(); ++lane) {
            const SurfaceRow<Scalar>& surface = out_.surfaces[ids[lane]];
            const FlatRow<Scalar>& flat = out_.flats[ids[lane] - scene_.spheres.size()];
            for (int i = 0; i < 3; ++i) {
                block.corner[i][lane] = flat.value[FlatRow<Scalar>::kCorner + i];
                block.normal[i][lane] = surface.value[SurfaceRow<Scalar>::kCenter + i];
                block.dual_u[i][lane] = flat.value[FlatRow<Scalar>::kDualU + i];
                block.dual_v[i][lane] = flat.value[FlatRow<Scalar>::kDualV + i];
                block.low[i][lane] = static_cast<Scalar>(boxes[lane].low[i]);
                block.high[i][lane] = static_cast<Scalar>(boxes[lane].high[i]);
            }
            block.id[lane] = static_cast<std::int32_t>(ids[lane]);
        }
        return block;
    }

    template <class Block, int width, class MakeBlock>
    BlockTree<Block, Scalar, width> block_tree(const std::vector<Box>& boxes, const Ids& ids,
                                               MakeBlock make_block) const {
        WideBvh<Scalar, width> bvh = collapse<Scalar, width>(build_binary_bvh(boxes, width));
        BlockTree<Block, Scalar, width> tree;
        for (const auto& leaf : bvh.leaves) {
            Ids in_leaf;
            for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) in_leaf.push_back(ids[bvh.order[i]]);
            tree.blocks.push_back(make_block(in_leaf));
        }
        tree.nodes = std::move(bvh.nodes);
        tree.depth = bvh.depth;
        return tree;
    }

    const Scene& scene_;
    CompiledScene<Scalar> out_;
};

template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
    return v.size() * sizeof(T);
}

}  // namespace

template <class Scalar>
std::size_t CompiledScene<Scalar>::bytes() const {
    return sizeof(*this) + bytes_of(surfaces) + bytes_of(textures) + bytes_of(flats) + bytes_of(images) +
           bytes_of(texels) + bytes_of(large_spheres) + bytes_of(planes) + bytes_of(sphere_tree.nodes) +
           bytes_of(sphere_tree.blocks) + bytes_of(quad_tree.nodes) + bytes_of(quad_tree.blocks);
}

template <class Scalar>
CompiledScene<Scalar> compile(const Scene& scene) {
    return Compiler<Scalar>(scene).compile();
}

template struct CompiledScene<float>;
template struct CompiledScene<double>;
template CompiledScene<float> compile(const Scene&);
template CompiledScene<double> compile(const Scene&);

}  // namespace raypool
