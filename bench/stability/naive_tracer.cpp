/// The loop of a per-pixel tracer with one naive method in the place of ours. All else is core/'s, so that nothing but
/// the method makes the difference.
#include <array>
#include <functional>
#include <numbers>
#include <vector>

#include "bench/naive/checkers.h"
#include "bench/naive/spheres.h"
#include "bench/stability/failures.h"
#include "core/geometry/any_hit.h"
#include "core/shading/shade.h"
#include "recursive/engine.h"

namespace raypool::stability {

namespace {

/// The distance to a sphere, which the ray may be leaving.
using SphereDistance = std::function<float(const Ray<float>&, const Vec3<float>& center, float radius, bool leaving)>;

float least_distance(const Ray<float>& ray, const Vec3<float>& center, float radius, bool) {
    return naive::haines_distance<float>(ray.origin, ray.direction, center, radius, naive::kBookEpsilon);
}
float our_distance(const Ray<float>& ray, const Vec3<float>& center, float radius, bool leaving) {
    return sphere_distance<float>(ray.origin, ray.direction, center, radius, leaving);
}
float half_b_distance(const Ray<float>& ray, const Vec3<float>& center, float radius, bool leaving) {
    if (leaving) return our_distance(ray, center, radius, leaving);
    return naive::half_b_distance<float>(ray.origin, ray.direction, center, radius);
}

/// A scene whose spheres are tested one by one, by `distance`.
class NaiveSpheres {
  public:
    NaiveSpheres(const SceneView<float>& scene, SphereDistance distance)
        : scene_(scene), others_(static_cast<const ShapeView<float>&>(scene)), distance_(std::move(distance)) {
        others_.large_spheres = {};
        others_.sphere_tree = {};
    }

    [[nodiscard]] Hit<float> closest_hit(const Ray<float>& ray, std::int32_t leaving_id) const {
        NoTestCount work;
        Hit<float> hit = raypool::closest_hit<kEverything>(others_, ray, leaving_id, work);
        for (const auto& blocks : {scene_.large_spheres, scene_.sphere_tree.blocks}) {
            for (const auto& block : blocks) {
                for (int i = 0; i < block.kLanes && block.id[i] != kNoPrimitive; ++i) {
                    const Vec3<float> center = vec3<float>(block.center[0][i], block.center[1][i], block.center[2][i]);
                    const float t = distance_(ray, center, block.radius[i], block.id[i] == leaving_id);
                    if (t < hit.t) hit = {t, block.id[i]};
                }
            }
        }
        return hit;
    }

  private:
    const SceneView<float>& scene_;
    ShapeView<float> others_;
    SphereDistance distance_;
};

/// Whether a hit is on an odd cell of a checker, by rounding towards zero.
bool is_odd_by_truncation(const SceneView<float>& scene, const Ray<float>& ray, const Hit<float>& hit) {
    const float* row = scene.surfaces[static_cast<std::size_t>(hit.primitive_id)].value;
    const SurfaceCode<std::int32_t> code{bits_of<float>(row[SurfaceRow<float>::kCode])};
    if (code.texture() != static_cast<int>(Texture::Kind::Checker3d)) return false;
    using Row = TextureRow<float>;
    const float* texture = scene.textures[static_cast<std::size_t>(code.texture_row())].value;
    const Vec3<float> p = surface_point<kEverything, float>(ray, hit.t, row).position;
    float sum = 0;
    for (int i = 0; i < 3; ++i)
        sum += naive::truncated_parity<float>(p[i] + texture[Row::kOffset + i], texture[Row::kScaleHigh]);
    return sum == 1 || sum == 3;
}

/// The scene with its checkers all even, or all odd.
CompiledScene<float> plain_checkers(Scene scene, bool is_odd) {
    for (Texture& texture : scene.textures) {
        if (texture.kind != Texture::Kind::Checker3d) continue;
        if (is_odd) texture.even = texture.odd;
        texture.kind = Texture::Kind::Solid;
    }
    return compile<float>(scene);
}

/// Whether nothing lies within that part of the way to the sampled point of a light.
bool is_free(const NaiveSpheres& scene, const RayStart<float>& start, const LightSample<float>& light, float part) {
    const Vec3<float> point = along<float>(start.origin, light.t, light.direction);
    const Vec3<float> to = point - start.origin;
    const float distance = to.norm();
    return !(scene.closest_hit({start.origin, to / distance, 0}, start.leaving_id).t < part * distance);
}
bool is_seen(NaiveVariant variant, const SceneView<float>& ours, const NaiveSpheres& scene,
             const RayStart<float>& start, const LightSample<float>& light) {
    if (variant == NaiveVariant::WholeShadowRay) return is_free(scene, start, light, 1);
    if (variant == NaiveVariant::ShortShadowRay) return is_free(scene, start, light, 1 - 1e-4F);
    NoTestCount work;
    return !is_occluded<kEverything>(ours, Ray<float>{start.origin, light.direction, 0}, start.leaving_id,
                                     Occlusion<float>{light.t, light.primitive_id}, work);
}

/// The scene with its image's density over the square taken for one over the sphere; the view lives by `texels`.
SceneView<float> without_sine(const SceneView<float>& scene, std::vector<EnvironmentTexel<float>>& texels) {
    SceneView<float> changed = scene;
    constexpr double kPi = std::numbers::pi;
    const EnvironmentView<float>& environment = scene.environment;
    texels.assign(environment.texels.begin(), environment.texels.end());
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const auto row = static_cast<std::int64_t>(i) / environment.width;
        const double sine = std::sin(kPi * (static_cast<double>(row) + 0.5) / environment.height);
        texels[i].value[EnvironmentTexel<float>::kDensity] *= static_cast<float>(2 * kPi * kPi * sine / (4 * kPi));
    }
    changed.environment.texels = texels;
    return changed;
}

}  // namespace

void render_naively(NaiveVariant variant, const Scene& scene, const RenderSettings& settings,
                    Framebuffer& framebuffer) {
    using enum NaiveVariant;
    if (variant == IdAlone) {
        recursive::IterativeEngine().render(compile<float>(scene, no_coincidence(scene)), settings, framebuffer);
        return;
    }
    const CompiledScene<float> compiled = compile<float>(scene);
    std::vector<EnvironmentTexel<float>> texels;
    const SceneView<float>& view = compiled;
    const SceneView<float> ours = variant == NoSine ? without_sine(view, texels) : view;
    const LightSampling sampling = needed_light_sampling(ours.features, settings);
    const std::array plain{plain_checkers(scene, false), plain_checkers(scene, true)};
    const NaiveSpheres spheres(ours, variant == LeastDistance ? least_distance
                                     : variant == HalfB       ? half_b_distance
                                                              : our_distance);
    const RandomSeed seed = random_seed(settings.seed, settings.sampler);
    const auto radiance = [&](std::int64_t x, std::int64_t y, const PathKey<float>& key) {
        Ray<float> ray = camera_ray<kEverything, float>(ours.camera, static_cast<float>(x), static_cast<float>(y),
                                                        key.pixel, key.sample, seed);
        Vec3<float> throughput = vec3<float>(1, 1, 1);
        Vec3<float> sum = vec3<float>(0, 0, 0);
        LightPart<float> lights;
        lights.sampling = sampling;
        lights.depth = settings.depth;
        std::int32_t leaving_id = kNoPrimitive;
        for (std::uint32_t step = 0; step < static_cast<std::uint32_t>(settings.depth); ++step) {
            lights.arriving_density = lights.density;
            const Hit<float> hit = spheres.closest_hit(ray, leaving_id);
            if (hit.primitive_id == kNoPrimitive)
                return Vec3<float>(sum + escaping_radiance<kEverything, float>(ours, ray.direction, throughput,
                                                                               sampling, lights.arriving_density));
            const bool is_odd = variant == Truncation && is_odd_by_truncation(ours, ray, hit);
            const SceneView<float>& looks = variant == Truncation ? plain[is_odd ? 1 : 0] : ours;
            const Scattered<float> out = scatter<kEverything, float>(looks, ray, hit.t, hit.primitive_id, throughput,
                                                                     key, step, seed, 0, false, &lights);
            if (lights.has_shadow_ray && is_seen(variant, ours, spheres, out.start, lights.light))
                sum += lights.radiance;
            if (out.is_emitter) return Vec3<float>(sum + out.throughput);
            if (!out.is_alive) break;
            ray = {out.start.origin, out.direction, ray.time};
            leaving_id = out.start.leaving_id;
            throughput = out.throughput;
        }
        return sum;
    };
#pragma omp parallel num_threads(settings.threads)
    {
        const FlushDenormals flush;
        SampleConverter converter(framebuffer.fixed_point());
#pragma omp for schedule(dynamic)
        for (std::int64_t y = 0; y < scene.height; ++y) {
            for (std::int64_t x = 0; x < scene.width; ++x) {
                const std::int64_t pixel = y * scene.width + x;
                for (std::int64_t sample = settings.first_sample; sample < settings.end_sample; ++sample) {
                    const PathKey<float> key{static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(sample)};
                    framebuffer.add(pixel, converter.convert<float>(radiance(x, y, key)));
                }
            }
        }
    }
}

}  // namespace raypool::stability
