/// From settings to a session: what wavefront/engine.h declares, as a template.
///
/// Sessions are compiled in sessions.cpp, once for each kind of record. Stages are compiled in stages_*.cpp, a file for
/// each of the large ones: they take most of the time that the project takes to build.
#pragma once

#include "core/geometry/traverse.h"
#include "core/shading/shade.h"
#include "wavefront/engine.h"
#include "wavefront/list_count.h"
#include "wavefront/record_stages.h"

namespace raypool::wavefront {

/// A register of rays, as stages take them.
template <class Scalar>
using WideReal = Wide<Scalar, stdx::native_simd<Scalar>::size()>;

/// Makes Stages<features, Real, Work, splitting>. A file that instantiates it includes compiled_stages.h.
template <Features features, class Real, class Work, Splitting splitting>
StagesMaker<record_features(features), ScalarOf<Real>> stages_maker();

/// In float for all kinds of record, in double for those of moving shapes.
template <Features features, class Scalar>
std::unique_ptr<RenderSession> begin_session(const CompiledScene<Scalar>&, const RenderSettings&, const PoolSettings&,
                                             Framebuffer&, const StagesMaker<features, Scalar>&);

template <Features features, class Real, class Work, Splitting splitting>
std::unique_ptr<RenderSession> begin(const CompiledScene<ScalarOf<Real>>& scene, const RenderSettings& settings,
                                     const PoolSettings& pool, Framebuffer& framebuffer) {
    return begin_session<record_features(features), ScalarOf<Real>>(scene, settings, pool, framebuffer,
                                                                    stages_maker<features, Real, Work, splitting>());
}

/// Picks the code compiled for the features of the scene. One code counts and splits, for all features.
template <class Real>
std::unique_ptr<RenderSession> begin(const CompiledScene<ScalarOf<Real>>& scene, const RenderSettings& settings,
                                     const PoolSettings& pool, Framebuffer& framebuffer) {
    if (settings.split_depth > 0 || settings.count_work)
        return begin<kEverything, Real, ListCount, Splitting::On>(scene, settings, pool, framebuffer);
    return dispatch_features<kFirstCompiledFeatures<ScalarOf<Real>>>(
        needed_features(scene.features, settings), [&]<Features features>() {
            return begin<features, Real, NoTestCount, Splitting::Off>(scene, settings, pool, framebuffer);
        });
}

}  // namespace raypool::wavefront
