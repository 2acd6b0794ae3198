// One path after the other, with rtcIntersect1.

#include <limits>

#include "bench/peers/materials.h"
#include "bench/peers/tile.h"

namespace raypool::peers {

namespace {

using Row = Rows<float>;
using Vec = V3<float>;

class SingleTracer {
  public:
    explicit SingleTracer(const Tile& tile) : tile_(tile), random_(seeded(tile.seed, tile.first_stream)) {}

    Vec path(int pixel_column, int pixel_row) {
        const CameraRay<float> camera_ray =
            tile_.camera.ray(static_cast<float>(pixel_column), static_cast<float>(pixel_row), random_);
        Vec origin = camera_ray.origin;
        Vec direction = camera_ray.direction;
        Vec throughput{1, 1, 1};
        RTCRayHit ray{};
        ray.ray.time = camera_ray.time;
        ray.ray.mask = ~0U;
        ray.ray.id = kNothing;

        for (std::int32_t left = tile_.depth; left > 0; --left) {
            ray.ray.org_x = origin.x, ray.ray.org_y = origin.y, ray.ray.org_z = origin.z;
            ray.ray.dir_x = direction.x, ray.ray.dir_y = direction.y, ray.ray.dir_z = direction.z;
            ray.ray.tfar = std::numeric_limits<float>::infinity();
            tile_.scene.intersect(ray);
            ++segments_;
            if (ray.hit.geomID == kNothing) return throughput * tile_.sky.radiance(direction);

            const auto id = static_cast<int>(ray.hit.primID);
            const Row row(tile_.scene, id);
            const SurfacePoint<float> point = surface_point(row, origin, direction, ray.ray.time, ray.ray.tfar);
            throughput =
                throughput * (row.is_mapped() ? mapped_colour(tile_.scene, id, point.outward, ray.hit.u, ray.hit.v)
                                              : colour(row, point.position));
            const auto kind = static_cast<Material::Kind>(row.value(Surface::kMaterial));
            if (kind == Material::Kind::Emissive) return throughput;
            direction = scattered(kind, row.value(Surface::kParameter), point, direction);
            const bool is_absorbed = kind == Material::Kind::Metal && dot(direction, point.normal) <= 0;
            if (is_absorbed || (throughput.x == 0 && throughput.y == 0 && throughput.z == 0)) break;
            origin = point.position;
            ray.ray.id = ray.hit.primID;
        }
        return {0, 0, 0};
    }

    [[nodiscard]] std::int64_t segments() const { return segments_; }

  private:
    Vec scattered(Material::Kind kind, float parameter, const SurfacePoint<float>& point, Vec direction) {
        if (kind == Material::Kind::Diffuse) return diffuse(point.normal, sphere_point());
        const Vec mirrored = mirror(direction, point.normal);
        if (kind == Material::Kind::Dielectric)
            return glass(direction, mirrored, point.normal, point.is_front, parameter, random_.next());
        return parameter > 0 ? fuzzy(mirrored, parameter, sphere_point()) : unit_or(mirrored, point.normal);
    }

    Vec sphere_point() {
        const float u = random_.next();
        return on_sphere(u, random_.next());
    }

    const Tile& tile_;
    Xoshiro<float> random_;
    std::int64_t segments_ = 0;
};

}  // namespace

std::int64_t trace_single(const Tile& tile) {
    SingleTracer tracer(tile);
    double* sum = tile.sums;
    for (int row = 0; row < tile.height; ++row) {
        for (int column = 0; column < tile.width; ++column, sum += 3) {
            for (std::int64_t sample = 0; sample < tile.spp; ++sample) {
                const Vec radiance = tracer.path(tile.x + column, tile.y + row);
                sum[0] += radiance.x, sum[1] += radiance.y, sum[2] += radiance.z;
            }
        }
    }
    return tracer.segments();
}

}  // namespace raypool::peers
