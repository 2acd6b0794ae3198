#include <array>

#include "bench/naive/checkers.h"
#include "bench/naive/spheres.h"
#include "bench/stability/failures.h"
#include "core/geometry/sphere_method.h"
#include "core/shading/checker_method.h"

namespace raypool {

// Before any kernel is instantiated for these variants; no other file of the program does so.

template <>
struct SphereMethod<1> {
    template <class Real>
    RAYPOOL_INLINE static Real distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& center,
                                        const Real& radius, const Mask<Real>&) {
        return naive::haines_distance<Real>(origin, direction, center, radius, Real(naive::kBookEpsilon));
    }
};

template <>
struct SphereMethod<2> {
    template <class Real>
    RAYPOOL_INLINE static Real distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& center,
                                        const Real& radius, const Mask<Real>& is_leaving) {
        const Real first = naive::half_b_distance<Real>(origin, direction, center, radius, Real(0));
        const Real second = raypool::sphere_distance<Real>(origin, direction, center, radius, is_leaving);
        return select(is_leaving, second, first);
    }
};

template <>
struct CheckerMethod<3> {
    template <class Real>
    RAYPOOL_INLINE static Mask<Real> is_odd(const Vec3<Real>& p, const Vec3<Real>&, const TwoParts<Real>& scale) {
        Real sum(0);
        for (int i = 0; i < 3; ++i) sum = sum + naive::truncated_parity<Real>(p[i], scale.high);
        return sum == Real(1) || sum == Real(3);
    }
};

}  // namespace raypool

#include "recursive/render.h"

namespace raypool::stability {

namespace {

/// Quads, glass and checkers in space. All members are written out: bench/studies/feature_engines.h says why.
template <NaiveVariant variant>
constexpr Features kFeatures{false, false, true, false, false,
                             true,  false, true, false, static_cast<std::uint8_t>(variant)};

template <NaiveVariant variant>
RenderReport render(const CompiledScene<float>& scene, const RenderSettings& settings, Framebuffer& framebuffer) {
    using recursive::Form;
    return render_whole(
        *recursive::begin<Form::Iterative, kFeatures<variant>, float, NoTestCount>(scene, settings, framebuffer),
        settings);
}

}  // namespace

RenderReport render_naively(NaiveVariant variant, const CompiledScene<float>& scene, const RenderSettings& settings,
                            Framebuffer& framebuffer) {
    using enum NaiveVariant;
    constexpr auto kRenders = std::array{render<LeastDistance>, render<HalfB>, render<Truncation>, render<IdAlone>};
    return kRenders[static_cast<std::size_t>(variant) - 1](scene, settings, framebuffer);
}

}  // namespace raypool::stability
