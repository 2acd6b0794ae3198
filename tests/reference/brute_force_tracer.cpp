#include "tests/reference/brute_force_tracer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/reference/flat_shapes.h"

namespace raypool::test {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFar = std::numeric_limits<double>::infinity();
/// No hit is closer: what a ray starts on is at 0 to rounding.
constexpr double kLeast = 1e-7;

struct Ball {
    Vec center, motion;
    double radius;
    int material_id;
};

struct Hit {
    double t = kFar;
    const Ball* ball = nullptr;
    const Flat* flat = nullptr;
};

class Tracer {
  public:
    Tracer(const Scene& scene, std::uint64_t seed) : scene_(scene), random_(seed) {
        for (const Sphere& s : scene.spheres)
            balls_.push_back({vec(s.center0), vec(s.center1) - vec(s.center0), s.radius, s.material_id});
        for (const Quad& q : scene.quads) {
            add(vec(q.corner), vec(q.edge_u), vec(q.edge_v), Flat::Kind::Quad, q.material_id);
        }
        for (const MeshShape& shape : scene.meshes) {
            const Mesh& mesh = *shape.mesh;
            const bool is_mirrored = shape.is_mirrored();
            for (const auto& [a, b, c] : mesh.triangles) {
                const auto placed = [&](std::uint32_t i) { return vec(shape.placed(mesh.positions[i])); };
                Flat& flat = add(placed(a), placed(b) - placed(a), placed(c) - placed(a), Flat::Kind::Triangle,
                                 shape.material_id);
                if (is_mirrored) flat.normal = -1 * flat.normal;
                const std::uint32_t corners[3] = {a, b, c};
                flat.is_smooth = !mesh.normals.empty();
                for (int i = 0; i < 3 && flat.is_smooth; ++i) {
                    flat.corners[i] = placed(corners[i]);
                    flat.normals[i] = placed_normal(shape, mesh.normals[corners[i]]);
                }
                for (int i = 0; i < 3 && !mesh.uv.empty(); ++i)
                    flat.texture[i] = {mesh.uv[corners[i]][0], mesh.uv[corners[i]][1]};
            }
        }
        for (const Plane& p : scene.planes) {
            const Vec n = unit(vec(p.normal));
            const Vec axis = std::abs(n.x) < 0.9 ? Vec{1, 0, 0} : Vec{0, 0, 1};
            const Vec u = unit(axis - dot(axis, n) * n);
            flats_.push_back({vec(p.point), n, u, cross(n, u), Flat::Kind::Plane, p.material_id});
        }

        const CameraDescription& camera = scene.camera;
        const bool has_lens = camera.defocus_angle_degrees > 0;
        const double distance = has_lens ? camera.focus_distance : 1;
        const Vec forward = unit(vec(camera.look_at) - vec(camera.look_from));
        const Vec right = unit(cross(forward, vec(camera.up)));
        const Vec down = cross(forward, right);
        const double height = 2 * distance * std::tan(camera.vertical_fov_degrees * kPi / 360);
        const double pixel = height / static_cast<double>(scene.height);
        const double lens = has_lens ? distance * std::tan(camera.defocus_angle_degrees * kPi / 360) : 0;
        pixel_right_ = pixel * right;
        pixel_down_ = pixel * down;
        lens_right_ = lens * right;
        lens_down_ = lens * down;
        corner_ = distance * forward - static_cast<double>(scene.width) / 2 * pixel_right_ -
                  static_cast<double>(scene.height) / 2 * pixel_down_;
    }

    /// The radiance of one path through the pixel.
    Vec path(double column, double row, int depth) {
        const double x = column + number();
        const double y = row + number();
        const double radius = std::sqrt(number());
        const double angle = 2 * kPi * number();
        const Vec shift = radius * std::cos(angle) * lens_right_ + radius * std::sin(angle) * lens_down_;
        const double open = scene_.camera.shutter_open;
        const double time = open + number() * (scene_.camera.shutter_close - open);
        Vec origin = vec(scene_.camera.look_from) + shift;
        Vec direction = unit(corner_ + x * pixel_right_ + y * pixel_down_ - shift);
        Vec throughput{1, 1, 1};

        for (int left = depth; left > 0; --left) {
            ++segments_;
            const Hit hit = closest(origin, direction, time);
            if (hit.t == kFar) return throughput * sky(direction);
            origin = origin + hit.t * direction;
            const Vec outward =
                hit.flat != nullptr ? hit.flat->normal : 1 / hit.ball->radius * (origin - center(*hit.ball, time));
            const bool is_front = dot(direction, outward) < 0;
            const Vec side = is_front ? outward : -1 * outward;
            const Smooth smooth = hit.flat != nullptr && hit.flat->is_smooth
                                      ? smooth_at(*hit.flat, origin, side, direction)
                                      : Smooth{side, {}, false};
            const Vec normal = smooth.normal;
            bool is_through = false;
            const int id = hit.flat != nullptr ? hit.flat->material_id : hit.ball->material_id;
            const Material& material = scene_.materials[static_cast<std::size_t>(id)];
            if (material.kind != Material::Kind::Dielectric)
                throughput = throughput * colour(material.texture_id, origin, outward, hit.flat);
            const Vec mirrored = direction - 2 * dot(direction, normal) * normal;
            switch (material.kind) {
                case Material::Kind::Emissive:
                    if (material.front_only && !is_front) return {};
                    return material.strength * throughput;
                case Material::Kind::Diffuse:
                    direction = unit(normal + on_sphere());
                    break;
                case Material::Kind::Metal:
                    direction = unit(mirrored + material.fuzz * on_sphere());
                    if (dot(direction, normal) <= 0) return {};
                    break;
                case Material::Kind::Dielectric:
                    direction = glass(direction, mirrored, normal, is_front ? 1 / material.ior : material.ior);
                    is_through = dot(direction, normal) < 0;
                    break;
            }
            // A smooth triangle loses what leaves its smooth surface and not itself, unless the ray starts above it.
            if (is_through ? dot(direction, side) >= 0 : !smooth.is_above && dot(direction, side) <= 0) return {};
            if (!is_through) origin = origin + smooth.lift;
            if (throughput.x == 0 && throughput.y == 0 && throughput.z == 0) return {};
        }
        return {};
    }
    [[nodiscard]] std::int64_t segments() const { return segments_; }

  private:
    Flat& add(Vec corner, Vec u, Vec v, Flat::Kind kind, int material_id) {
        const Vec n = cross(u, v);
        const double square = dot(n, n);  // of the area: what makes the coordinates run from 0 to 1
        flats_.push_back({corner, unit(n), 1 / square * cross(v, n), 1 / square * cross(n, u), kind, material_id});
        return flats_.back();
    }

    /// In [0, 1).
    double number() { return static_cast<double>(random_() >> 11U) * 0x1p-53; }

    Vec on_sphere() {
        const double z = 1 - 2 * number();
        const double angle = 2 * kPi * number();
        const double radius = std::sqrt(std::max(0.0, 1 - z * z));
        return {radius * std::cos(angle), radius * std::sin(angle), z};
    }

    static Vec center(const Ball& ball, double time) { return ball.center + time * ball.motion; }

    [[nodiscard]] Hit closest(Vec origin, Vec direction, double time) const {
        Hit hit;
        for (const Ball& ball : balls_) {
            const Vec to_center = center(ball, time) - origin;
            const double b = dot(to_center, direction);
            const double discriminant = b * b - dot(to_center, to_center) + ball.radius * ball.radius;
            if (discriminant < 0) continue;
            const double root = std::sqrt(discriminant);
            const double t = b - root > kLeast ? b - root : b + root;
            if (t > kLeast && t < hit.t) hit = {t, &ball, nullptr};
        }
        for (const Flat& flat : flats_) {
            const double t = dot(flat.corner - origin, flat.normal) / dot(direction, flat.normal);
            if (!(t > kLeast && t < hit.t)) continue;
            const auto [u, v] = coordinates(flat, origin + t * direction);
            const double most_v = flat.kind == Flat::Kind::Triangle ? 1 - u : 1;
            if (flat.kind != Flat::Kind::Plane && (u < 0 || u > 1 || v < 0 || v > most_v)) continue;
            hit = {t, nullptr, &flat};
        }
        return hit;
    }

    [[nodiscard]] Vec sky(Vec direction) const {
        if (scene_.background.image) return sky_image(direction);
        const double up = (direction.y + 1) / 2;
        return (1 - up) * vec(scene_.background.bottom) + up * vec(scene_.background.top);
    }

    /// The texel in a direction, by spherical coordinates: longitude grows from -z, in the middle, to +x, at three
    /// quarters; the image is turned by the right-hand rule around +y.
    [[nodiscard]] Vec sky_image(Vec direction) const {
        const Image& image = *scene_.background.image;
        const double longitude = std::atan2(direction.x, -direction.z) + scene_.background.rotation_degrees * kPi / 180;
        const double latitude = std::asin(std::clamp(direction.y, -1.0, 1.0));
        const auto place = [](double part, std::int64_t size) {
            return std::clamp<std::int64_t>(static_cast<std::int64_t>(part * static_cast<double>(size)), 0, size - 1);
        };
        const double around = 0.5 + longitude / (2 * kPi);
        const float* texel =
            image.pixel(place(around - std::floor(around), image.width), place(0.5 - latitude / kPi, image.height));
        return scene_.background.scale * Vec{texel[0], texel[1], texel[2]};
    }

    /// By Fresnel's equations for unpolarised light (Born and Wolf, "Principles of Optics", 1.5.2); `eta` is the index
    /// of refraction on this side over that beyond.
    Vec glass(Vec direction, Vec mirrored, Vec normal, double eta) {
        const double cos_in = -dot(direction, normal);
        const double sin2_out = eta * eta * (1 - cos_in * cos_in);
        const double chance = number();
        if (sin2_out >= 1) return mirrored;
        const double cos_out = std::sqrt(1 - sin2_out);
        const double across = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
        const double within = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
        if (chance < (across * across + within * within) / 2) return mirrored;
        return unit(eta * direction + (eta * cos_in - cos_out) * normal);
    }

    static bool is_odd_cell(double x, double y, double z) {
        return std::fmod(std::abs(std::floor(x) + std::floor(y) + std::floor(z)), 2) == 1;
    }

    /// `flat` is null on a sphere.
    [[nodiscard]] Vec colour(int texture_id, Vec p, Vec outward, const Flat* flat) const {
        const Texture& texture = scene_.textures[static_cast<std::size_t>(texture_id)];
        if (texture.kind == Texture::Kind::Solid) return vec(texture.even);
        if (texture.kind == Texture::Kind::Checker3d) {
            const Vec at = 1 / texture.scale * (p + 1e-9 * outward + vec(texture.offset));
            return vec(is_odd_cell(at.x, at.y, at.z) ? texture.odd : texture.even);
        }
        const auto [u, v] = flat != nullptr ? texture_coordinates(*flat, p)
                                            : Coordinates{0.5 + std::atan2(-outward.z, outward.x) / (2 * kPi),
                                                          0.5 + std::asin(std::clamp(outward.y, -1.0, 1.0)) / kPi};
        if (texture.kind == Texture::Kind::CheckerUv)
            return vec(is_odd_cell(u / texture.scale, v / texture.scale, 0) ? texture.odd : texture.even);
        const bool repeats =
            texture.wrap == Texture::Wrap::Repeat ||
            (texture.wrap == Texture::Wrap::ByShape && (flat == nullptr || flat->kind != Flat::Kind::Quad));
        return image_colour(*texture.image, u, v, repeats, repeats && flat != nullptr);
    }

    /// Bilinear between the centres of texels.
    static Vec image_colour(const Image& image, double u, double v, bool repeats_u, bool repeats_v) {
        const double x = u * static_cast<double>(image.width) - 0.5;
        const double y = (1 - v) * static_cast<double>(image.height) - 0.5;
        const auto texel = [&](double column, double row) {
            const auto place = [](double at, std::int64_t size, bool repeats) {
                const auto n = static_cast<double>(size);
                return static_cast<std::int64_t>(repeats ? at - n * std::floor(at / n) : std::clamp(at, 0.0, n - 1));
            };
            const float* p = image.pixel(place(column, image.width, repeats_u), place(row, image.height, repeats_v));
            return Vec{p[0], p[1], p[2]};
        };
        const double left = std::floor(x);
        const double top = std::floor(y);
        const auto line = [&](double row) {
            return (left + 1 - x) * texel(left, row) + (x - left) * texel(left + 1, row);
        };
        return (top + 1 - y) * line(top) + (y - top) * line(top + 1);
    }

    const Scene& scene_;
    std::mt19937_64 random_;
    std::vector<Ball> balls_;
    std::vector<Flat> flats_;
    Vec corner_, pixel_right_, pixel_down_, lens_right_, lens_down_;
    std::int64_t segments_ = 0;
};

}  // namespace

BruteForceRender brute_force_render(const Scene& scene, int spp, int depth, std::uint64_t seed) {
    Tracer tracer(scene, seed);
    BruteForceRender out{{}, 0};
    for (std::int64_t y = 0; y < scene.height; ++y) {
        for (std::int64_t x = 0; x < scene.width; ++x) {
            Vec sum;
            for (int i = 0; i < spp; ++i)
                sum = sum + tracer.path(static_cast<double>(x), static_cast<double>(y), depth);
            for (const double channel : {sum.x, sum.y, sum.z}) out.rgb.push_back(channel / spp);
        }
    }
    out.segments_per_path =
        static_cast<double>(tracer.segments()) / static_cast<double>(scene.width * scene.height * spp);
    return out;
}

}  // namespace raypool::test
