/// What a kernel is given: plain values and pointers into the memory of a device.
#pragma once

#include <cstdint>

#include "core/film/sample_converter.h"
#include "core/math/random.h"
#include "core/shading/compiled_scene.h"
#include "core/shading/lights.h"

namespace raypool::gpu {

/// What threads count together.
struct Counters {
    std::uint64_t next_path = 0;  ///< of the launch: the first that no thread has taken
    std::uint64_t segments = 0;
    std::uint64_t shadow_rays = 0;
    std::uint64_t non_finite = 0;  ///< SampleStatistics
    std::uint64_t clamped = 0;
    double clamped_energy = 0;
    std::uint32_t live[2] = {0, 0};  ///< records in each of the two pools
    std::uint32_t queued = 0;        ///< shadow rays of the round
    std::uint32_t rounds = 0;        ///< that had records
};

/// The pools of Form::Wave: columns of 32-bit words, as long as the capacity each.
struct WaveMemory {
    std::uint32_t capacity = 0;
    std::uint32_t* records[2] = {nullptr, nullptr};  ///< of RayRecord<float>
    std::uint32_t* hits = nullptr;                   ///< of Hit<float>
    std::uint32_t* shadow_rays = nullptr;            ///< of ShadowRay; null where lights are not sampled
};

struct Launch {
    SceneView<float> scene;  ///< its tables are in the device's memory
    RandomSeed seed{};
    std::int32_t depth = 0;
    bool roulette = false;
    LightSampling light_sampling = LightSampling::None;
    SampleConverter converter{FixedPoint{}};  ///< to be copied by each thread
    bool has_halves = false;

    // Path p is sample first_sample + p / pixel_count of the pixel with the number p % pixel_count, so that neighbours
    // of a warp are neighbours in the image.
    std::int64_t first_sample = 0;
    std::int64_t pixel_count = 0;
    const std::uint32_t* pixels = nullptr;  ///< by their numbers; null where these are the pixels
    std::int64_t path_count = 0;

    std::int64_t* sums = nullptr;  ///< of the framebuffer
    Counters* counters = nullptr;
    WaveMemory wave;
    int pool = 0;  ///< which of the two holds the records of the round
};

}  // namespace raypool::gpu
