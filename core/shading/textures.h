/// Colours that vary over a surface: checkers in space, checkers in surface coordinates, and images.
#pragma once

#include <cstdint>

#include "core/math/sampling.h"

namespace raypool {

/// A number and what its Scalar could not hold of it, for products that must land in the right cell far from the
/// origin.
template <class Real>
struct TwoParts {
    Real high;
    Real low;
};

/// How far, in cells along an axis, the cell of a surface is looked up on the surface's outward side, so that a surface
/// that lies in a boundary of cells takes the cell before it, not one of two as rounding has it. More than the rounding
/// of a position put back onto a surface and of offset and sum, 4 roundoffs of |p| + |offset| in all; and a part of a
/// cell, for surfaces that are off the boundary by the rounding of their own normal.
template <class Real>
RAYPOOL_INLINE Real outward_part(const Real& p, const Real& offset, const TwoParts<Real>& scale, const Real& outward) {
    constexpr ScalarOf<Real> kPart = 4 * std::numeric_limits<ScalarOf<Real>>::epsilon();
    return mad<Real>(abs(p) + abs(offset), scale.high, Real(1)) * (outward * Real(kPart));
}

/// Whether the whole number below x * scale + part is odd, as 0 or 1, for any |x * scale| < 2^47 in float: the
/// product's rounding error is carried along, so the answer does not degrade with distance as floor(x * scale) does.
template <class Real>
RAYPOOL_INLINE Real cell_parity(const Real& x, const TwoParts<Real>& scale, const Real& part = Real(0)) {
    const Real high = x * scale.high;
    const Real low = mad<Real>(x, scale.low, mad<Real>(x, scale.high, -high));
    const Real cell = floor(high);
    const Real carry = floor((high - cell) + (low + part));
    const auto parity = [](const Real& a) { return nmad<Real>(Real(2), floor(a * Real(0.5F)), a); };
    return parity(parity(cell) + parity(carry));
}

/// True where the cell of a 3-D checker at p, moved by outward_part(), has an odd sum of indices.
template <class Real>
RAYPOOL_INLINE Mask<Real> is_odd_cell(const Vec3<Real>& p, const Vec3<Real>& outward, const TwoParts<Real>& scale) {
    Real sum = cell_parity<Real>(p[0], scale, outward[0]);
    for (int i = 1; i < 3; ++i) sum = sum + cell_parity<Real>(p[i], scale, outward[i]);
    return sum == Real(1) || sum == Real(3);
}

/// Surface coordinates of a sphere at its unit outward normal: u once around the y axis from -x, v from the pole at -y
/// (0) to that at +y (1).
template <class Real>
RAYPOOL_INLINE std::array<Real, 2> sphere_coordinates(const Vec3<Real>& n) {
    const Real around = turn_of_angle<Real>(-n[2], n[0]) + Real(0.5F);
    const Real u = select(around >= Real(1), around - Real(1), around);
    const Real v = Real(2) * turn_of_angle<Real>(sqrt(mad<Real>(n[0], n[0], n[2] * n[2])), -n[1]);
    return {u, v};
}

/// An image: rows from the top, four scalars a texel (r, g, b, unused).
template <class Scalar>
struct ImageView {
    const Scalar* texels = nullptr;
    std::int32_t width = 0;
    std::int32_t height = 0;
};

/// Where an image lies in the compiled scene's table of texels.
struct ImagePlace {
    std::int64_t first = 0;  ///< scalar
    std::int32_t width = 0;
    std::int32_t height = 0;

    template <class Scalar>
    [[nodiscard]] RAYPOOL_INLINE ImageView<Scalar> view(const Scalar* texels) const {
        return {texels + first, width, height};
    }
};

/// Whether an image begins anew beyond its edges along u, and along v; where not, its edge goes on.
struct ImageRepeat {
    bool u = false;
    bool v = false;

    [[nodiscard]] constexpr int number() const { return int{u} + 2 * int{v}; }
    static constexpr ImageRepeat of_number(int number) { return {(number & 1) != 0, (number & 2) != 0}; }
};

/// Bilinear lookup, v upward. One lane at a time: images are rare, and their memory is the cost.
template <class Scalar>
RAYPOOL_HOST_DEVICE Vec3<Scalar> image_colour(const ImageView<Scalar>& image, Scalar u, Scalar v, ImageRepeat repeat) {
    struct Place {
        std::int32_t first, second;  // texels, ...
        Scalar weight;               // ... of the second
    };
    const auto place = [](Scalar at, std::int32_t size, bool repeats) -> Place {
        const Scalar half(0.5F);
        const Scalar wanted = (repeats ? at - floor(at) : at) * Scalar(size) - half;
        const Scalar x = repeats ? max(min(wanted, Scalar(size) - half), -half)  // NaN, of an infinite place, as well
                                 : max(min(wanted, Scalar(size - 1)), Scalar(0));
        const Scalar below = floor(x);
        const auto first = static_cast<std::int32_t>(below);
        const std::int32_t beyond = repeats ? 0 : size - 1;
        return {first < 0 ? size - 1 : first, first + 1 < size ? first + 1 : beyond, x - below};
    };
    const Place column = place(u, image.width, repeat.u);
    const Place row = place(Scalar(1) - v, image.height, repeat.v);
    const auto texel = [&](std::int32_t c, std::int32_t r) {
        const Scalar* p = image.texels + 4 * (std::int64_t{r} * image.width + c);
        return vec3<Scalar>(p[0], p[1], p[2]);
    };
    const auto mix = [](const Vec3<Scalar>& a, const Vec3<Scalar>& b, Scalar w) {
        return vec3<Scalar>(mad(w, b[0] - a[0], a[0]), mad(w, b[1] - a[1], a[1]), mad(w, b[2] - a[2], a[2]));
    };
    return mix(mix(texel(column.first, row.first), texel(column.second, row.first), column.weight),
               mix(texel(column.first, row.second), texel(column.second, row.second), column.weight), row.weight);
}

}  // namespace raypool
