/// What every device must render to the bit: scenes by forms, samplers, light sampling and capacities.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "gpu/engine.h"
#include "tests/equivalence/same_image.h"

namespace raypool::gpu {

struct FormCase {
    std::string name;
    std::string scene;
    std::int64_t width;
    std::int64_t spp;
    std::int32_t depth = 50;
    Sampler sampler = Sampler::Independent;
    bool roulette = false;
    LightSampling light_sampling = LightSampling::None;
};

/// For the test's name.
inline void PrintTo(const FormCase& test, std::ostream* out) {
    *out << test.name;
}

inline const std::vector<FormCase> kFormCases{
    {"paper", "paper", 33, 2},
    {"caustic", "caustic", 24, 2},
    {"cornell", "cornell", 20, 2},
    {"furnace", "furnace", 16, 2},
    {"glass_stack", "glass_stack", 24, 2},
    {"half_sky", "half_sky", 32, 2},
    {"instances", "instances", 32, 2},
    {"many_lights", "many_lights", 24, 2},
    {"mirror_corridor", "mirror_corridor", 17, 1, 200},
    {"one_sphere", "one_sphere", 16, 2},
    {"sky_image", "sky_image", 24, 2},
    {"small_lamp", "small_lamp", 24, 2},
    {"smooth", "smooth", 32, 2},
    {"solids", "solids", 32, 2},
    {"textures", "textures", 33, 2},
    {"paper_by_sobol", "paper", 24, 3, 50, Sampler::Sobol},
    {"cornell_by_roulette", "cornell", 20, 2, 50, Sampler::Independent, true},
    {"cornell_by_mis", "cornell", 20, 2, 50, Sampler::Independent, false, LightSampling::Mis},
    {"many_lights_by_light", "many_lights", 20, 2, 50, Sampler::Sobol, false, LightSampling::Light},
    {"sky_image_by_mis", "sky_image", 20, 2, 50, Sampler::Sobol, true, LightSampling::Mis},
    {"solids_by_mis", "solids", 32, 2, 50, Sampler::Sobol, true, LightSampling::Mis},
    {"instances_by_mis", "instances", 32, 2, 50, Sampler::Independent, true, LightSampling::Mis},
    {"smooth_by_light", "smooth", 24, 2, 50, Sampler::Independent, false, LightSampling::Light},
    {"only_camera_rays", "paper", 17, 1, 1},
    {"no_depth", "paper", 9, 1, 0},
};

inline RenderSettings settings_of(const FormCase& test) {
    RenderSettings settings;
    settings.end_sample = test.spp;
    settings.depth = test.depth;
    settings.sampler = test.sampler;
    settings.roulette = test.roulette;
    settings.light_sampling = test.light_sampling;
    return settings;
}

/// Pools of the wave: one that holds all paths, and ones that do not.
inline const std::vector<GpuSettings> kForms{
    {Form::Mega, 1}, {Form::MegaRegenerate, 1}, {Form::Wave, 1 << 14}, {Form::Wave, 100}, {Form::Wave, 33}};

inline std::string describe(const GpuSettings& gpu) {
    constexpr const char* kNames[] = {"mega", "mega-regenerate", "wave"};
    return fmt::format("{}, {} records", kNames[static_cast<int>(gpu.form)], gpu.capacity);
}

/// Whether all forms make the image, and count the rays, of the per-pixel tracer.
inline void check_forms(const FormCase& test, const DeviceMaker& device,
                        const std::vector<GpuSettings>& forms = kForms) {
    const CompiledScene<float> scene = compile<float>(small_scene(test.scene, test.width));
    RenderSettings settings = settings_of(test);
    const Rendered expected = render(recursive::IterativeEngine(), scene, settings);
    settings.threads = 2;
    for (const GpuSettings& gpu : forms) {
        const Rendered got = render(GpuEngine(gpu, device), scene, settings);
        EXPECT_TRUE(same_image("gpu_" + test.name, expected, got, describe(gpu)));
        EXPECT_EQ(got.report.segments(), expected.report.segments()) << describe(gpu);
        EXPECT_EQ(got.report.total(&ThreadReport::shadow_rays), expected.report.total(&ThreadReport::shadow_rays));
        EXPECT_EQ(got.report.paths(), expected.report.paths());
        EXPECT_EQ(got.report.statistics.non_finite, expected.report.statistics.non_finite);
        EXPECT_EQ(got.report.statistics.clamped, expected.report.statistics.clamped);
    }
}

}  // namespace raypool::gpu
