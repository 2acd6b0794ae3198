/// A configuration: everything but the samples per pixel that decides what an image costs and how wrong it is; and the
/// simplifications of it that advice tries one at a time.
///
/// Called by the study of speed and accuracy and by `raypool advise`.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/statistics.h"
#include "core/runtime/engine.h"
#include "core/scene/scene.h"
#include "core/shading/compiled_scene.h"

namespace raypool::accuracy {

enum class EngineKind : std::uint8_t { Recursive, Pool };
enum class Precision : std::uint8_t { Float, Double };

/// More segments than any sensible render asks for: where the depth matters at all, recursion no longer fits into a
/// stack.
inline constexpr std::int32_t kDeep = 1000;

struct Configuration {
    EngineKind engine = EngineKind::Pool;
    Precision precision = Precision::Float;
    Sampler sampler = Sampler::Independent;
    bool roulette = false;
    std::int32_t depth = 50;
    int split_depth = 0;
    LightSampling light_sampling = LightSampling::None;  ///< nothing of it is done where a scene has no lights

    bool operator==(const Configuration&) const = default;
};

/// The one that references are made with: double, deep, nothing that saves time but the pool.
inline constexpr Configuration kTrusted{.precision = Precision::Double, .depth = kDeep};

/// What differs from the default: "float pool" or "double recursion, depth 5, split 1, mis".
std::string to_string(const Configuration& configuration);
/// The flags of `raypool render` that say the same; those that say the command's default too, but for light sampling
/// where the scene has no lights.
std::string render_flags(const Configuration& configuration, const Features& scene);

/// A scene in both precisions, which share nothing but the description.
struct SceneInBoth {
    explicit SceneInBoth(const Scene& scene)
        : description(scene), in_float(compile<float>(scene)), in_double(compile<double>(scene)) {}
    Scene description;
    CompiledScene<float> in_float;
    CompiledScene<double> in_double;
    [[nodiscard]] std::int64_t pixel_count() const { return in_float.pixel_count(); }
};

/// That of references: the trusted one, but that it samples lights where there are some, by mis. Its expectation is the
/// same, and small lamps are found.
Configuration reference_configuration(const SceneInBoth& scene);

struct Taken {
    std::int64_t first_sample = 0;
    std::int64_t end_sample = 1;
    std::uint64_t seed = 0;
    int threads = 1;
};

/// What the image depends on.
ImageSettings image_settings(const Configuration& configuration, std::uint64_t seed);
/// Of a framebuffer for so many samples a pixel.
FixedPoint fixed_point(const Configuration& configuration, const SceneInBoth& scene, std::int64_t spp);

/// Adds samples to a framebuffer of the scene's size.
RenderReport render_into(Framebuffer& framebuffer, const Configuration& configuration, const SceneInBoth& scene,
                         const Taken& taken);

/// An image by itself: samples 0 to end_sample.
struct TimedImage {
    Values values;  ///< channel means
    RenderReport report;
    std::string hash;
};
TimedImage render_image(const Configuration& configuration, const SceneInBoth& scene, const Taken& taken);

/// Means of a framebuffer's sums, in double: an Image has floats, whose steps would show beside small errors.
Values channel_means(const Framebuffer& framebuffer, std::int64_t sample_count);

/// What a change is a change of. Groups are combined in this order, at most one change of each.
enum class Group : std::uint8_t { Precision, Engine, Sampler, Roulette, Split, Lights, Depth };

/// One simplification: of the trusted configuration where it is of the precision, else of its twin in float.
struct Change {
    std::string text;
    Group group;
    std::function<void(Configuration&)> apply;

    [[nodiscard]] Configuration applied(Configuration to) const {
        apply(to);
        return to;
    }
};

/// The trusted configuration for a scene: as deep as it takes until nothing is left of a path's throughput, and not so
/// deep as to follow paths in a closed room on and on.
Configuration trusted_for(const CompiledScene<double>& scene);

/// The first is that to float. Of light sampling only mis is one: alone it has no bound that a promise could use.
std::vector<Change> changes(const Features& scene, const Configuration& trusted);

}  // namespace raypool::accuracy
