#include "bench/naive/checkers.h"
#include "bench/naive/spheres.h"
#include "bench/stability/failures.h"
#include "core/methods.h"

namespace raypool {

// Before any kernel is instantiated for these variants; no other file of the program does so.

template <>
struct Methods<1> {
    template <class Real>
    RAYPOOL_INLINE static Real sphere_distance(const Vec3<Real>& origin, const Vec3<Real>& direction,
                                               const Vec3<Real>& center, const Real& radius, const Mask<Real>&) {
        return naive::haines_distance<Real>(origin, direction, center, radius, Real(naive::kBookEpsilon));
    }
    template <class Real>
    RAYPOOL_INLINE static Mask<Real> is_odd_cell(const Vec3<Real>& p, const Vec3<Real>& outward,
                                                 const Split<Real>& scale) {
        return raypool::is_odd_cell<Real>(p, outward, scale);
    }
};

template <>
struct Methods<2> {
    template <class Real>
    RAYPOOL_INLINE static Real sphere_distance(const Vec3<Real>& origin, const Vec3<Real>& direction,
                                               const Vec3<Real>& center, const Real& radius,
                                               const Mask<Real>& is_leaving) {
        const Real first = naive::half_b_distance<Real>(origin, direction, center, radius, Real(0));
        const Real second = raypool::sphere_distance<Real>(origin, direction, center, radius, is_leaving);
        return select(is_leaving, second, first);
    }
    template <class Real>
    RAYPOOL_INLINE static Mask<Real> is_odd_cell(const Vec3<Real>& p, const Vec3<Real>& outward,
                                                 const Split<Real>& scale) {
        return raypool::is_odd_cell<Real>(p, outward, scale);
    }
};

template <>
struct Methods<3> {
    template <class Real>
    RAYPOOL_INLINE static Real sphere_distance(const Vec3<Real>& origin, const Vec3<Real>& direction,
                                               const Vec3<Real>& center, const Real& radius,
                                               const Mask<Real>& is_leaving) {
        return raypool::sphere_distance<Real>(origin, direction, center, radius, is_leaving);
    }
    template <class Real>
    RAYPOOL_INLINE static Mask<Real> is_odd_cell(const Vec3<Real>& p, const Vec3<Real>&, const Split<Real>& scale) {
        Real sum(0);
        for (int i = 0; i < 3; ++i) sum = sum + naive::truncated_parity<Real>(p[i], scale.high);
        return sum == Real(1) || sum == Real(3);
    }
};

}  // namespace raypool

#include "recursive/render.h"

namespace raypool::stability {

namespace {

/// Quads, glass and checkers in space. All members are written out: bench/studies/needs_engines.h says why.
template <NaiveVariant variant>
constexpr SceneNeeds kNeeds{false, false, true, false, false,
                            true,  false, true, false, static_cast<std::uint8_t>(variant)};

template <NaiveVariant variant>
RenderReport render(const CompiledScene<float>& scene, const RenderSettings& settings, Framebuffer& framebuffer) {
    using recursive::Form;
    return render_whole(
        *recursive::begin<Form::Iterative, kNeeds<variant>, float, NoWorkCount>(scene, settings, framebuffer),
        settings);
}

}  // namespace

RenderReport render_naively(NaiveVariant variant, const CompiledScene<float>& scene, const RenderSettings& settings,
                            Framebuffer& framebuffer) {
    switch (variant) {
        case NaiveVariant::LeastDistance:
            return render<NaiveVariant::LeastDistance>(scene, settings, framebuffer);
        case NaiveVariant::HalfB:
            return render<NaiveVariant::HalfB>(scene, settings, framebuffer);
        case NaiveVariant::IdAlone:
            return render<NaiveVariant::IdAlone>(scene, settings, framebuffer);
        case NaiveVariant::Truncation:
            break;
    }
    return render<NaiveVariant::Truncation>(scene, settings, framebuffer);
}

}  // namespace raypool::stability
