#include "core/shading/light_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "core/scene/emission.h"

namespace raypool {

namespace {

constexpr double kRandomSteps = 1 << 24;  ///< random numbers are multiples of 2^-24

/// An entry of the alias table: kept with the probability `threshold`.
struct AliasEntry {
    double threshold = 1;
    std::size_t alias = 0;
};

std::vector<AliasEntry> alias_table(std::vector<double> shares) {
    const std::size_t count = shares.size();
    std::vector<AliasEntry> table(count);
    std::vector<std::size_t> poor;
    std::vector<std::size_t> rich;
    for (std::size_t i = 0; i < count; ++i) {
        shares[i] *= static_cast<double>(count);
        table[i].alias = i;
        (shares[i] < 1 ? poor : rich).push_back(i);
    }
    while (!poor.empty() && !rich.empty()) {
        const std::size_t filled = poor.back();
        poor.pop_back();
        const std::size_t giver = rich.back();
        table[filled] = {shares[filled], giver};
        shares[giver] -= 1 - shares[filled];
        if (shares[giver] < 1) {
            rich.pop_back();
            poor.push_back(giver);
        }
    }
    // What is left is 1 to rounding. Random numbers go by steps, and a threshold of whole steps is met exactly.
    for (AliasEntry& entry : table) entry.threshold = std::round(entry.threshold * kRandomSteps) / kRandomSteps;
    return table;
}

/// The number of random numbers for which sample_light() draws a row before `row`: it rounds a product in Scalar.
template <class Scalar>
double steps_before(std::size_t row, std::size_t count) {
    if (row == count) return kRandomSteps;
    const auto drawn = [count](double step) {
        return std::floor(static_cast<Scalar>(step / kRandomSteps) * static_cast<Scalar>(count));
    };
    const auto first = static_cast<double>(row);
    double step = std::ceil(first * kRandomSteps / static_cast<double>(count));
    while (step > 0 && drawn(step - 1) >= first) --step;
    return step;
}

/// With which probability each light is chosen.
template <class Scalar>
std::vector<double> chances(const std::vector<AliasEntry>& table) {
    std::vector<double> chances(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double drawn =
            (steps_before<Scalar>(i + 1, table.size()) - steps_before<Scalar>(i, table.size())) / kRandomSteps;
        chances[i] += drawn * table[i].threshold;
        chances[table[i].alias] += drawn * (1 - table[i].threshold);
    }
    return chances;
}

}  // namespace

template <class Scalar>
LightTable<Scalar> light_table(const Scene& scene, const std::vector<bool>& is_hidden) {
    using Row = LightRow<Scalar>;
    LightTable<Scalar> table;
    const EmittedPower emitted(scene);
    std::vector<double> powers;
    std::vector<double> areas;  ///< of spheres 1: their density is one of solid angle
    const auto set = [](Row& row, int column, const Vector3d& v) {
        for (int i = 0; i < 3; ++i) row.value[column + i] = static_cast<Scalar>(v[i]);
    };
    const auto add = [&](std::size_t primitive_id, double power, double area) -> Row& {
        powers.push_back(power);
        areas.push_back(area);
        Row& row = table.rows.emplace_back(Row{});
        row.value[Row::kPrimitive] = of_bits<Scalar>(static_cast<Int<Scalar>>(primitive_id));
        return row;
    };
    for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
        const Sphere& sphere = scene.spheres[i];
        const double power = emitted.of(sphere);
        if (power == 0 || is_hidden[i]) continue;
        Row& row = add(i, power, 1);
        set(row, Row::kPoint, sphere.center0);
        set(row, Row::kEdgeU, sphere.center1 - sphere.center0);
        row.value[Row::kRadius] = static_cast<Scalar>(sphere.radius);
    }
    for (std::size_t i = 0; i < scene.quads.size(); ++i) {
        const Quad& quad = scene.quads[i];
        const double power = emitted.of(quad);
        const std::size_t id = scene.spheres.size() + i;
        if (power == 0 || is_hidden[id]) continue;
        Row& row = add(id, power, quad.edge_u.cross(quad.edge_v).norm());
        set(row, Row::kPoint, quad.corner);
        set(row, Row::kEdgeU, quad.edge_u);
        set(row, Row::kEdgeV, quad.edge_v);
    }
    if (table.rows.empty()) return table;

    const double sum = std::accumulate(powers.begin(), powers.end(), 0.0);
    for (double& power : powers) power /= sum;
    const std::vector<AliasEntry> entries = alias_table(powers);
    const std::vector<double> chosen = chances<Scalar>(entries);
    table.weights.resize(scene.spheres.size() + scene.quads.size() + scene.planes.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        Row& row = table.rows[i];
        row.value[Row::kThreshold] = static_cast<Scalar>(entries[i].threshold);
        row.value[Row::kAlias] = of_bits<Scalar>(static_cast<Int<Scalar>>(entries[i].alias));
        if (chosen[i] > 0)  // else it is found by chance alone
            table.weights[static_cast<std::size_t>(bits_of<Scalar>(row.value[Row::kPrimitive]))] =
                std::max(static_cast<Scalar>(chosen[i] / areas[i]), std::numeric_limits<Scalar>::min());
    }
    return table;
}

template LightTable<float> light_table(const Scene&, const std::vector<bool>&);
template LightTable<double> light_table(const Scene&, const std::vector<bool>&);

}  // namespace raypool
