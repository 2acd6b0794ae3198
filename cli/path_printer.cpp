#include "cli/path_printer.h"

#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "cli/print.h"
#include "core/math/flush_denormals.h"
#include "gpu/path.h"

namespace raypool::cli {

namespace {

std::string text(const Vec3<float>& v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v[0], v[1], v[2]);
}

std::string shape_text(const Scene& scene, const char* kind, std::size_t number, std::int32_t material_id) {
    constexpr const char* kKinds[Material::kKindCount] = {"diffuse", "metal", "dielectric", "emissive"};
    const Material& material = scene.materials[static_cast<std::size_t>(material_id)];
    return fmt::format("{} {}, {}", kind, number, kKinds[static_cast<std::size_t>(material.kind)]);
}

/// "sphere 3, metal": of its kind the shape with this number, from 0 on, as the scene lists them.
std::string primitive_text(const Scene& scene, std::int32_t primitive_id) {
    auto i = static_cast<std::size_t>(primitive_id);
    if (i < scene.spheres.size()) return shape_text(scene, "sphere", i, scene.spheres[i].material_id);
    i -= scene.spheres.size();
    if (i < scene.quads.size()) return shape_text(scene, "quad", i, scene.quads[i].material_id);
    i -= scene.quads.size();
    if (i < scene.planes.size()) return shape_text(scene, "plane", i, scene.planes[i].material_id);
    i -= scene.planes.size();
    for (const bool are_instances : {false, true}) {
        for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
            const MeshShape& shape = scene.meshes[mesh];
            if (scene.is_instance(shape) != are_instances) continue;
            const std::size_t count = shape.mesh->triangles.size();
            if (i < count)
                return fmt::format("triangle {} of {}", i, shape_text(scene, "mesh", mesh, shape.material_id));
            i -= count;
        }
    }
    return fmt::format("primitive {}", primitive_id);
}

/// Follows a path and returns what it brings home.
FixedRgb print_path(const Scene& scene, const gpu::Launch& launch, std::int64_t path, SampleConverter& converter) {
    using gpu::ShadowRay;
    FixedRgb sum{};
    const auto bring_home = [&](const char* what, const Vec3<float>& radiance) {
        const FixedRgb fixed = converter.convert<float>(radiance);
        for (std::size_t k = 0; k < 3; ++k) sum[k] += fixed[k];
        if (radiance != vec3<float>(0, 0, 0)) print("     {}: brings home {}\n", what, text(radiance));
    };
    RayRecord<float> record = gpu::camera_record<kEverything>(launch, path);
    const auto width = static_cast<std::uint32_t>(launch.scene.width);
    print("pixel {},{} sample {}: from {} along {}, time {:.6g}\n", record.key.pixel % width, record.key.pixel / width,
          record.key.sample, text(record.ray.origin), text(record.ray.direction), record.ray.time);
    for (bool is_alive = launch.depth > 0; is_alive;) {
        const Hit<float> hit = gpu::trace<kEverything>(launch, record);
        const bool is_escaped = hit.primitive_id == kNoPrimitive;
        if (is_escaped) {
            print("  {:>2} leaves the scene along {}\n", record.step + 1, text(record.ray.direction));
        } else {
            print("  {:>2} {} at {}, distance {:.6g}\n", record.step + 1, primitive_text(scene, hit.primitive_id),
                  text(along<float>(record.ray.origin, hit.t, record.ray.direction)), hit.t);
        }
        is_alive = gpu::shade<kEverything>(
            launch, hit, record,
            [&](const Vec3<float>& radiance) { bring_home(is_escaped ? "background" : "it shines", radiance); },
            [&](const ShadowRay& shadow) {
                const std::string light = primitive_text(scene, static_cast<std::int32_t>(shadow.light_id));
                if (gpu::is_seen<kEverything>(launch, shadow)) {
                    bring_home(("light from " + light).c_str(), shadow.radiance);
                } else {
                    print("     light from {}: hidden\n", light);
                }
            });
        if (is_alive)
            print("     goes on along {}, throughput {}\n", text(record.ray.direction), text(record.throughput));
    }
    return sum;
}

}  // namespace

void print_paths(const Scene& scene, const CompiledScene<float>& compiled, const RenderRecord& record,
                 const Framebuffer& rendered) {
    const FlushDenormals flush;
    const RenderSettings& settings = record.settings;
    gpu::Launch launch;
    launch.scene = compiled;
    launch.seed = random_seed(settings.seed, settings.sampler);
    launch.depth = settings.depth;
    launch.roulette = settings.roulette;
    launch.light_sampling = settings.light_sampling;
    launch.first_sample = settings.first_sample;
    SampleConverter converter(rendered.fixed_point());
    for (const std::uint32_t pixel : *settings.pixels) {
        launch.pixels = &pixel;
        launch.pixel_count = 1;
        FixedRgb sum{};
        for (std::int64_t path = 0; path < settings.end_sample - settings.first_sample; ++path) {
            const FixedRgb brought = print_path(scene, launch, path, converter);
            for (std::size_t k = 0; k < 3; ++k) sum[k] += brought[k];
        }
        if (sum != rendered.sum(pixel))
            throw std::runtime_error("--pixel: the paths that are printed bring home other light than those rendered");
    }
}

}  // namespace raypool::cli
