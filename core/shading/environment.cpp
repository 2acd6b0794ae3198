#include "core/shading/environment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/scene/emission.h"

namespace raypool {

namespace {

/// 1 - cos of the angle between the pole +y and the upper edge of a row.
double height_below_pole(std::int64_t row, std::int64_t row_count) {
    const double half = std::sin(std::numbers::pi / 2 * static_cast<double>(row) / static_cast<double>(row_count));
    return 2 * half * half;
}

/// Divides by the sum, unless that is 0: then all are alike, and the table is not used.
std::vector<AliasEntry> table_of(std::vector<double> shares) {
    const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (double& share : shares) share = sum > 0 ? share / sum : 1 / static_cast<double>(shares.size());
    return alias_table(std::move(shares));
}

template <class Row>
void set_entry(Row& row, const AliasEntry& entry) {
    using Scalar = std::remove_cvref_t<decltype(row.value[0])>;
    row.value[Row::kThreshold] = static_cast<Scalar>(entry.threshold);
    row.value[Row::kAlias] = of_bits<Scalar>(static_cast<Int<Scalar>>(entry.alias));
}

}  // namespace

template <class Scalar>
EnvironmentTables<Scalar> environment_tables(const Background& background, double chance) {
    using Texel = EnvironmentTexel<Scalar>;
    using Row = EnvironmentRow<Scalar>;
    EnvironmentTables<Scalar> tables;
    if (!background.image) return tables;
    const Image& image = *background.image;
    tables.texels.reserve(image.rgb.size() / 3);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        Texel& texel = tables.texels.emplace_back(Texel{});
        for (std::size_t k = 0; k < 3; ++k)
            texel.value[Texel::kRadiance + k] = static_cast<Scalar>(background.scale * image.rgb[i + k]);
    }
    if (chance == 0) return tables;

    // Rows by the light that comes from them, ...
    const auto brightness = [&](std::int64_t row) {
        std::vector<double> sums;
        for (const float* p = image.pixel(0, row); std::ssize(sums) < image.width; p += 3)
            sums.push_back(double{p[0]} + p[1] + p[2]);
        return sums;
    };
    std::vector<double> shares;
    for (std::int64_t row = 0; row < image.height; ++row) {
        const std::vector<double> sums = brightness(row);
        shares.push_back(std::accumulate(sums.begin(), sums.end(), 0.0) * texel_solid_angle(image, row));
    }
    const std::vector<AliasEntry> rows = table_of(std::move(shares));
    const std::vector<double> row_chances = alias_chances(rows, draw_chances<Scalar>(rows.size()));
    for (std::int64_t i = 0; i < image.height; ++i) {
        Row& row = tables.rows.emplace_back();
        set_entry(row, rows[static_cast<std::size_t>(i)]);
        const bool is_lower = 2 * i >= image.height;
        const auto height = [&](std::int64_t edge) {
            return static_cast<Scalar>(height_below_pole(is_lower ? image.height - edge : edge, image.height));
        };
        row.value[Row::kTop] = height(i);
        row.value[Row::kBottom] = height(i + 1);
    }

    // ... and texels by their part of it.
    tables.entries.reserve(tables.texels.size());
    const std::vector<double> drawn = draw_chances<Scalar>(static_cast<std::size_t>(image.width));
    for (std::int64_t row = 0; row < image.height; ++row) {
        const std::vector<AliasEntry> entries = table_of(brightness(row));
        const std::vector<double> chances = alias_chances(entries, drawn);
        const double of_row = chance * row_chances[static_cast<std::size_t>(row)] / texel_solid_angle(image, row);
        for (std::size_t i = 0; i < entries.size(); ++i) {
            Texel& texel = tables.texels[tables.entries.size()];
            const double density = of_row * chances[i];
            if (density > 0)
                texel.value[Texel::kDensity] =
                    std::max(static_cast<Scalar>(density), std::numeric_limits<Scalar>::min());
            set_entry(tables.entries.emplace_back(), entries[i]);
        }
    }
    return tables;
}

template EnvironmentTables<float> environment_tables(const Background&, double);
template EnvironmentTables<double> environment_tables(const Background&, double);

}  // namespace raypool
