/// The features of a scene: what its kernels must have and its ray records must carry.
///
/// Derived from the scene once, by scene_features(). A kernel takes a Features as a template parameter and leaves out
/// what is false; for a scene that does not need a feature, leaving it out changes no bit of the image.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace raypool {

struct Features {
    bool motion = false;      ///< a sphere moves while the shutter is open: rays carry a time
    bool defocus = false;     ///< the lens has an area
    bool planar = false;      ///< quads, planes or triangles
    bool triangles = false;   ///< meshes
    bool metal = false;       ///< mirrors
    bool fuzz = false;        ///< mirrors that are not perfect
    bool dielectric = false;  ///< glass
    bool emissive = false;    ///< surfaces that shine
    bool checker = false;     ///< 3-D checkers
    bool uv = false;          ///< textures that need surface coordinates: uv checkers and images
    bool lights = false;      ///< emissive shapes with an end, or an image around the scene: light sampling is possible
    bool environment = false;  ///< the background is an image

    bool operator==(const Features&) const = default;
};

/// A feature by name, for listings and for tests that go through all of them.
struct FeatureName {
    const char* name;
    bool Features::*member;
};
inline constexpr std::array<FeatureName, 12> kFeatureNames{{{"motion", &Features::motion},
                                                            {"defocus", &Features::defocus},
                                                            {"planar", &Features::planar},
                                                            {"triangles", &Features::triangles},
                                                            {"metal", &Features::metal},
                                                            {"fuzz", &Features::fuzz},
                                                            {"dielectric", &Features::dielectric},
                                                            {"emissive", &Features::emissive},
                                                            {"checker", &Features::checker},
                                                            {"uv", &Features::uv},
                                                            {"lights", &Features::lights},
                                                            {"environment", &Features::environment}}};

/// True when code compiled for `a` can render a scene with features `b`.
constexpr bool covers(const Features& a, const Features& b) {
    for (const FeatureName& feature : kFeatureNames)
        if (b.*feature.member && !(a.*feature.member)) return false;
    return true;
}

Features scene_features(const Scene& scene);

/// Bytes of a ray record, the state of a path between two segments: origin, direction and throughput, three scalars
/// each; pixel, sample, primitive left and bounce, 4 bytes each; a time where shapes move; and the density of its
/// direction where lights are sampled. Defocus, fuzz, glass, textures and emission need none: they act within a
/// segment.
constexpr std::size_t ray_record_bytes(const Features& features, std::size_t scalar_bytes) {
    return 9 * scalar_bytes + 4 * sizeof(std::uint32_t) + (features.motion ? scalar_bytes : 0) +
           (features.lights ? scalar_bytes : 0);
}

/// The names of the features needed, in the order of kFeatureNames.
std::vector<std::string> feature_names(const Features& features);

inline constexpr Features kEverything{true, true, true, true, true, true, true, true, true, true, true, true};

constexpr Features without_triangles(Features features) {
    features.triangles = false;
    return features;
}

/// All but light sampling.
inline constexpr Features kAllButLights{true, true, true, true, true, true, true, true, true, true, false, true};

/// The sets of features that the engines are compiled for, smallest first. A scene runs on the first that covers it,
/// counted from kFirstCompiledFeatures on.
inline constexpr std::array<Features, 4> kCompiledFeatures{{
    {},
    {.motion = true, .defocus = true, .metal = true, .fuzz = true, .dielectric = true, .checker = true},
    kAllButLights,
    kEverything,
}};

constexpr std::size_t compiled_features_index(const Features& features, std::size_t first = 0) {
    std::size_t i = first;
    while (!covers(kCompiledFeatures[i], features)) ++i;
    return i;
}

/// The first of them in a precision. In double precision, where accuracy is what is asked for, nothing is compiled for
/// the first set alone: its scenes run on the second. A build with RAYPOOL_ONE_FEATURE_SET has the last alone.
template <class Scalar>
inline constexpr std::size_t kFirstCompiledFeatures =
#ifdef RAYPOOL_ONE_FEATURE_SET
    kCompiledFeatures.size() - 1;
#else
    sizeof(Scalar) > sizeof(float) ? 1 : 0;
#endif

/// Calls function.template operator()<compiled features>() with the first compiled set, from the i-th on, that covers
/// `features`.
template <std::size_t i = 0, class Function>
auto dispatch_features(const Features& features, Function&& function) {
    if constexpr (i + 1 < kCompiledFeatures.size()) {
        if (!covers(kCompiledFeatures[i], features)) return dispatch_features<i + 1>(features, function);
    }
    return function.template operator()<kCompiledFeatures[i]>();
}

}  // namespace raypool
