#include "cli/common_options.h"

#include "cli/options.h"
#include "core/math/path.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"

namespace raypool::cli {

void add_common_options(CLI::App& command, CommonOptions& options) {
    command.add_option("scene", options.scene, "Scene file, or the name of a built-in scene (default: paper)");
    command.add_option("--width", options.width, "Image width; the height follows (default: the scene's)")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{65536}));
    command
        .add_option("--height", options.height,
                    "Image height; the width follows, unless it is given too (default: by the width)")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{65536}));
    command.add_option("--depth", options.depth, "Most segments of a path (default: 50)")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{path_step::kMostBounces}));
    command
        .add_option("--split-depth", options.split_depth,
                    "Follow both rays, reflected and refracted, at the first N hits on glass (default: 0)")
        ->check(CLI::Range(0, path_step::kMostSplits));
    command.add_option("--seed", options.seed, "Seed of all random numbers (default: 0)");
    command
        .add_option("--sampler", options.sampler,
                    "How numbers lie in a pixel: independent or sobol (default: independent)")
        ->check(CLI::IsMember({"independent", "sobol"}));
    command.add_flag("--roulette", options.roulette, "End paths that carry little by chance, without bias");
    command
        .add_option("--light-sampling", options.light_sampling,
                    "How paths find emissive quads, spheres and meshes: none (by chance), light (by sampling them), or "
                    "mis (both, "
                    "weighted; the default)")
        ->check(CLI::IsMember({"none", "light", "mis"}));
    command.add_option("--threads", options.threads, "OpenMP threads (default: OMP_NUM_THREADS)")
        ->check(CLI::Range(1, 4096));
    command.add_option("--schedule", options.schedule,
                       "balanced, or static, dynamic, guided or tasks, and a chunk: dynamic,4 (default: OMP_SCHEDULE, "
                       "else balanced, with --grain dynamic)");
    command.add_option("--grain", options.grain,
                       "What a loop iteration renders, unless balanced: pixel, line or tile:N (default: line)");
}

RenderSettings common_settings(const CommonOptions& options) {
    RenderSettings settings;
    settings.depth = static_cast<std::int32_t>(options.depth);
    settings.split_depth = options.split_depth;
    settings.seed = parse_seed(options.seed);
    settings.sampler = parse_sampler(options.sampler);
    settings.roulette = options.roulette;
    settings.light_sampling = parse_light_sampling(options.light_sampling);
    settings.threads = thread_count(options.threads);
    if (options.grain) settings.grain = parse_grain(*options.grain);
    return settings;
}

Scene scene_of(const CommonOptions& options) {
    Scene scene = load_scene(options.scene);
    set_size(scene, options.width, options.height);
    return scene;
}

}  // namespace raypool::cli
