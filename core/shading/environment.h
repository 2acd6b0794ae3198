/// An image all around the scene: what a direction sees of it, and directions drawn by its brightness.
///
/// Radiance is constant over a texel, and within a texel directions are drawn evenly over the solid angle: so the
/// density with which a direction is drawn is constant over a texel too, and exact. A texel is chosen in two steps, its
/// row and then itself, so that no alias table has more entries than single precision draws evenly
/// (alias_table.h; Pharr, Jakob and Humphreys, "Physically Based Rendering", 12.5).
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "core/math/sampling.h"
#include "core/scene/scene.h"
#include "core/shading/alias_table.h"

namespace raypool {

template <class Scalar>
struct alignas(4 * sizeof(Scalar)) EnvironmentTexel {
    enum Column {
        kRadiance = 0,  ///< three
        kDensity = 3,   ///< of solid angle, with which light sampling draws a direction in it; 0 if it never does
        kColumns = 4
    };
    Scalar value[kColumns];
};

/// A row of the image as an entry of the alias table over rows, and where it lies. Of rows above the middle, and of the
/// one in the middle, heights are below the pole +y; of others above the pole -y. So small ones are exact.
template <class Scalar>
struct alignas(4 * sizeof(Scalar)) EnvironmentRow {
    enum Column {
        kThreshold = 0,
        kAlias = 1,   ///< the bits of a whole number
        kTop = 2,     ///< the height of its upper edge, ...
        kBottom = 3,  ///< ... and of its lower one
        kColumns = 4
    };
    Scalar value[kColumns];
};

/// A texel as an entry of the alias table over its row.
template <class Scalar>
struct EnvironmentEntry {
    enum Column { kThreshold = 0, kAlias = 1, kColumns = 2 };  ///< the alias: the bits of a column of the image
    Scalar value[kColumns];
};

/// All empty where there is no image; only `texels` is not where it is no light.
template <class Scalar>
struct EnvironmentTables {
    std::vector<EnvironmentTexel<Scalar>> texels;  ///< rows from the top
    std::vector<EnvironmentRow<Scalar>> rows;
    std::vector<EnvironmentEntry<Scalar>> entries;  ///< by texel
};

/// Of a background's image, if it has one. Light sampling chooses it with the probability `chance`.
template <class Scalar>
EnvironmentTables<Scalar> environment_tables(const Background& background, double chance);

extern template EnvironmentTables<float> environment_tables(const Background&, double);
extern template EnvironmentTables<double> environment_tables(const Background&, double);

template <class Scalar>
struct EnvironmentView {
    std::span<const EnvironmentTexel<Scalar>> texels;
    std::span<const EnvironmentRow<Scalar>> rows;
    std::span<const EnvironmentEntry<Scalar>> entries;
    std::int32_t width = 0;  ///< in texels
    std::int32_t height = 0;
    Scalar rotation = 0;  ///< in turns, within [0, 1)
};

namespace detail {

/// Whether all lanes have the number that is in the first one.
template <class Real>
RAYPOOL_INLINE bool are_alike(const Int<Real>& index) {
    return all(as_mask<Real>(index == Int<Real>(lane(index, 0))));
}

/// table[index], by lane.
template <class Real>
RAYPOOL_INLINE Real gather(const ScalarOf<Real>* table, const Int<Real>& index) {
    if constexpr (Simd<Real>) {
        if (are_alike<Real>(index)) return Real(table[lane(index, 0)]);
        return Real([&](auto i) { return table[index[i]]; });
    } else {
        return table[index];
    }
}

/// load_rows() of `columns` scalars from rows of as many, fast where all lanes ask for one row, as for an only light's.
template <int columns, class Real>
RAYPOOL_INLINE void load_light_rows(const ScalarOf<Real>* table, const Int<Real>& which, Real* row) {
    if (Simd<Real> && are_alike<Real>(which)) {
        const ScalarOf<Real>* only = table + columns * static_cast<std::ptrdiff_t>(lane(which, 0));
        for (int k = 0; k < columns; ++k) row[k] = Real(only[k]);
    } else {
        load_rows<columns, Real>(table, columns, which, row);
    }
}

}  // namespace detail

/// What a direction sees of the image.
template <class Real>
struct EnvironmentSight {
    Vec3<Real> radiance;
    Real density;  ///< EnvironmentTexel::kDensity
};

template <class Real>
RAYPOOL_INLINE EnvironmentSight<Real> environment_sight(const EnvironmentView<ScalarOf<Real>>& environment,
                                                        const Int<Real>& texel_id) {
    using Texel = EnvironmentTexel<ScalarOf<Real>>;
    Real texel[Texel::kColumns];
    load_rows<Texel::kColumns, Real>(environment.texels.data()->value, Texel::kColumns, texel_id, texel);
    return {vec3<Real>(texel[Texel::kRadiance], texel[Texel::kRadiance + 1], texel[Texel::kRadiance + 2]),
            texel[Texel::kDensity]};
}

/// The texel in a direction; some texel if it is NaN. A turn around the y axis goes from +z by -x, -z and +x.
template <class Real>
RAYPOOL_INLINE Int<Real> environment_texel(const EnvironmentView<ScalarOf<Real>>& environment,
                                           const Vec3<Real>& direction) {
    using S = ScalarOf<Real>;
    const Real across = sqrt(mad<Real>(direction[0], direction[0], direction[2] * direction[2]));
    const Real turn = turn_of_angle<Real>(-direction[0], direction[2]) + Real(environment.rotation);
    const Real down = Real(2) * turn_of_angle<Real>(across, direction[1]);
    const auto place = [](const Real& part, std::int32_t count) {
        return to_int<Real>(max(min(floor(part * Real(S(count))), Real(S(count - 1))), Real(0)));
    };
    return place(down, environment.height) * Int<Real>(environment.width) +
           place(turn - floor(turn), environment.width);
}

/// Of rays that leave the scene, whose background is an image. Never inlined: of scenes without, whose rays leave by
/// the same code, it takes no registers.
template <class Real>
[[gnu::noinline]] RAYPOOL_HOST_DEVICE EnvironmentSight<Real> see_environment(
    const EnvironmentView<ScalarOf<Real>>& environment, const Vec3<Real>& direction) {
    return environment_sight<Real>(environment, environment_texel<Real>(environment, direction));
}

/// A direction, drawn with the density of its texel.
template <class Real>
struct EnvironmentSample : EnvironmentSight<Real> {
    Vec3<Real> direction;  ///< unit
    Int<Real> texel_id;    ///< it is that of the direction but for rounding at edges
};

/// Of an image that is a light. `choice` is a block of RandomPurpose::Environment; `across` and `down` say where in the
/// texel, in [0, 1).
template <class Real>
[[gnu::noinline]] RAYPOOL_HOST_DEVICE EnvironmentSample<Real> sample_environment(
    const EnvironmentView<ScalarOf<Real>>& environment, const std::array<Real, 4>& choice, const Real& across,
    const Real& down) {
    using S = ScalarOf<Real>;
    using Row = EnvironmentRow<S>;
    using Entry = EnvironmentEntry<S>;
    const auto width = static_cast<S>(environment.width);

    Real row[Row::kColumns];
    const auto load = [&](const Int<Real>& which) {
        load_rows<Row::kColumns, Real>(environment.rows.data()->value, Row::kColumns, which, row);
    };
    const Int<Real> drawn_row = draw_entry<Real>(choice[0], static_cast<S>(environment.height));
    load(drawn_row);
    const Int<Real> row_id = select(choice[1] < row[Row::kThreshold], drawn_row, bits_of<Real>(row[Row::kAlias]));
    load(row_id);

    const Int<Real> first = row_id * Int<Real>(environment.width);
    const Int<Real> drawn_column = draw_entry<Real>(choice[2], width);
    const S* entries = environment.entries.data()->value;
    const Int<Real> entry = (first + drawn_column) * Int<Real>(int{Entry::kColumns});
    const Real threshold = detail::gather<Real>(entries, entry);
    const Real alias = detail::gather<Real>(entries, entry + Int<Real>(int{Entry::kAlias}));
    const Int<Real> column = select(choice[3] < threshold, drawn_column, bits_of<Real>(alias));

    EnvironmentSample<Real> sample;
    sample.texel_id = first + column;
    static_cast<EnvironmentSight<Real>&>(sample) = environment_sight<Real>(environment, sample.texel_id);
    const Real height = mad<Real>(down, row[Row::kBottom] - row[Row::kTop], row[Row::kTop]);
    const Real sine = sqrt(max(height * (Real(2) - height), Real(0)));
    const Real turn = (to_real<Real>(column) + across) / Real(width) + (Real(1) - Real(environment.rotation));
    const SinCos<Real> angle = sincos_of_turn<Real>(turn - floor(turn));
    const Mask<Real> is_lower = as_mask<Real>(row_id + row_id >= Int<Real>(environment.height));
    const Real y = Real(1) - height;
    sample.direction = unit<Real>(vec3<Real>(-(sine * angle.sin), select(is_lower, -y, y), sine * angle.cos));
    return sample;
}

}  // namespace raypool
