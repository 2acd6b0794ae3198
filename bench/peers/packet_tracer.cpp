// A packet of paths side by side, with rtcIntersect16 (or 8). A lane whose path has ended takes the next path of the
// tile, so the packet stays full until the tile runs out of paths.

#include <limits>

#include "bench/peers/materials.h"
#include "bench/peers/tile.h"

namespace raypool::peers {

namespace {

using Vec = V3<Wide>;

class PacketTracer {
  public:
    explicit PacketTracer(const Tile& tile) : tile_(tile), samples_left_(tile.spp) {
        for (int i = 0; i < kPacket; ++i) {
            const Xoshiro<float> random = seeded(tile.seed, tile.first_stream + static_cast<std::uint64_t>(i));
            random_.s0[i] = random.s0, random_.s1[i] = random.s1, random_.s2[i] = random.s2, random_.s3[i] = random.s3;
        }
        lanes(rays_.ray.mask) = ~WideUint{};
    }

    std::int64_t trace() {
        std::int64_t segments = 0;
        while (start_paths()) {
            lanes(rays_.ray.tfar) = all_lanes<Wide>(std::numeric_limits<float>::infinity());
            tile_.scene.intersect(is_active_, rays_);
            for (int i = 0; i < kPacket; ++i) segments -= is_active_[i];
            end_paths(scatter());
        }
        return segments;
    }

  private:
    /// Camera rays in the lanes that have no path. False when no path is left, neither in a lane nor to start.
    bool start_paths() {
        if (row_ < tile_.height) {
            WideInt is_new{};
            for (int i = 0; i < kPacket && row_ < tile_.height; ++i) {
                if (is_active_[i] != 0) continue;
                is_new[i] = -1;
                pixel_[i] = row_ * tile_.width + column_;
                pixel_x_[i] = static_cast<float>(tile_.x + column_);
                pixel_y_[i] = static_cast<float>(tile_.y + row_);
                next_path();
            }
            if (any(is_new)) generate(is_new);
            is_active_ |= is_new;
        }
        return any(is_active_);
    }

    void next_path() {
        if (--samples_left_ > 0) return;
        samples_left_ = tile_.spp;
        if (++column_ < tile_.width) return;
        column_ = 0;
        ++row_;
    }

    void generate(WideInt is_new) {
        const CameraRay<Wide> made = tile_.camera.ray(pixel_x_, pixel_y_, random_);
        PacketRay& ray = rays_.ray;
        set_ray(choose(is_new, made.origin, origin()), choose(is_new, made.direction, direction()),
                select(is_new, WideUint{} + kNothing, lanes(ray.id)));
        lanes(ray.time) = select(is_new, made.time, lanes(ray.time));
        throughput_ = choose(is_new, all_lanes<Wide>(V3<float>{1, 1, 1}), throughput_);
        segments_left_ = select(is_new, WideInt{} + tile_.depth, segments_left_);
    }

    [[nodiscard]] Vec origin() { return {lanes(rays_.ray.org_x), lanes(rays_.ray.org_y), lanes(rays_.ray.org_z)}; }
    [[nodiscard]] Vec direction() { return {lanes(rays_.ray.dir_x), lanes(rays_.ray.dir_y), lanes(rays_.ray.dir_z)}; }
    void set_ray(const Vec& origin, const Vec& direction, const WideUint& leaving) {
        PacketRay& ray = rays_.ray;
        lanes(ray.org_x) = origin.x, lanes(ray.org_y) = origin.y, lanes(ray.org_z) = origin.z;
        lanes(ray.dir_x) = direction.x, lanes(ray.dir_y) = direction.y, lanes(ray.dir_z) = direction.z;
        lanes(ray.id) = leaving;
    }

    /// Sets the paths' next rays, and the radiance that ended ones bring home. Returns which have ended.
    WideInt scatter() {
        const WideInt is_sky = lanes(rays_.hit.geomID) == kNothing;
        const WideInt id = select(is_sky, WideInt{}, std::bit_cast<WideInt>(lanes(rays_.hit.primID)));
        const Rows<Wide> rows(tile_.scene, id);
        const Vec arriving = direction();
        const Wide t = select(is_sky, Wide{}, lanes(rays_.ray.tfar));
        const SurfacePoint<Wide> point = surface_point<Wide>(rows, origin(), arriving, lanes(rays_.ray.time), t);

        // Light, from the sky or through the surface's colour.
        Vec colour_here = colour(rows, point.position);
        if (const WideInt is_mapped = rows.is_mapped() & ~is_sky & is_active_; any(is_mapped))
            look_up_maps(is_mapped, id, point.outward, colour_here);
        const Vec carried = throughput_ * choose(is_sky, tile_.sky.radiance(arriving), colour_here);

        // Direction, by material.
        const Wide kind = rows.value(Surface::kMaterial);
        const Wide parameter = rows.value(Surface::kParameter);
        const WideInt is_metal = kind == static_cast<float>(Material::Kind::Metal);
        const WideInt is_glass = kind == static_cast<float>(Material::Kind::Dielectric);
        const WideInt is_emitter = kind == static_cast<float>(Material::Kind::Emissive);
        const Wide u = random_.next();
        const Vec sphere_point = on_sphere(u, random_.next());
        const Vec mirrored = mirror(arriving, point.normal);
        Vec leaving = diffuse(point.normal, sphere_point);
        if (any(is_metal)) leaving = choose(is_metal, fuzzy(mirrored, parameter, sphere_point), leaving);
        if (any(is_glass)) {
            const Wide ior = select(is_glass, parameter, all_lanes<Wide>(1));
            leaving =
                choose(is_glass, glass(arriving, mirrored, point.normal, point.is_front, ior, random_.next()), leaving);
        }
        set_ray(point.position, leaving, lanes(rays_.hit.primID));

        // The end of a path.
        const WideInt has_light = is_sky | is_emitter;
        const WideInt is_absorbed = is_metal & (dot(leaving, point.normal) <= 0.0F);
        const WideInt is_black = (carried.x == 0.0F) & (carried.y == 0.0F) & (carried.z == 0.0F);
        throughput_ = carried;
        radiance_ = choose(has_light, carried, Vec{});
        segments_left_ -= 1;
        return is_active_ & (has_light | is_absorbed | is_black | (segments_left_ == 0));
    }

    /// Lane by lane: textures in surface coordinates are rare.
    void look_up_maps(const WideInt& is_mapped, const WideInt& id, const Vec& outward, Vec& colour_here) const {
        for (int i = 0; i < kPacket; ++i) {
            if (is_mapped[i] == 0) continue;
            const V3<float> found = mapped_colour(tile_.scene, id[i], {outward.x[i], outward.y[i], outward.z[i]},
                                                  rays_.hit.u[i], rays_.hit.v[i]);
            colour_here.x[i] = found.x, colour_here.y[i] = found.y, colour_here.z[i] = found.z;
        }
    }

    void end_paths(const WideInt& has_ended) {
        for (int i = 0; i < kPacket; ++i) {
            if (has_ended[i] == 0) continue;
            double* sum = tile_.sums + 3 * std::int64_t{pixel_[i]};
            sum[0] += radiance_.x[i], sum[1] += radiance_.y[i], sum[2] += radiance_.z[i];
        }
        is_active_ &= ~has_ended;
    }

    const Tile& tile_;

    // The next path to start.
    int column_ = 0;
    int row_ = 0;
    std::int64_t samples_left_;

    // The paths.
    alignas(64) PacketRayHit rays_{};
    WideInt is_active_{};  ///< -1 or 0, as Embree wants it
    WideInt pixel_{};
    Wide pixel_x_{}, pixel_y_{};
    WideInt segments_left_{};
    Vec throughput_{}, radiance_{};
    Xoshiro<Wide> random_{};
};

}  // namespace

std::int64_t trace_packets(const Tile& tile) {
    return PacketTracer(tile).trace();
}

}  // namespace raypool::peers
