#include "core/shading/light_table.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "core/geometry/triangles.h"
#include "core/math/vec.h"
#include "core/scene/emission.h"
#include "core/shading/alias_table.h"

namespace raypool {

namespace {

/// Where rays meet them: rounded, so that areas are those of what is met.
template <class Scalar>
std::array<Vec3<Scalar>, 3> placed_vertices(const MeshShape& shape, std::size_t triangle) {
    std::array<Vec3<Scalar>, 3> vertices;
    for (std::size_t i = 0; i < 3; ++i)
        vertices[i] = shape.placed(shape.mesh->positions[shape.mesh->triangles[triangle][i]]).template cast<Scalar>();
    return vertices;
}

}  // namespace

template <class Scalar>
LightTable<Scalar> light_table(const Scene& scene, const std::vector<bool>& is_hidden) {
    using Row = LightRow<Scalar>;
    LightTable<Scalar> table;
    const EmittedPower emitted(scene);
    std::vector<double> powers;
    std::vector<double> areas;  ///< 1 of what has a density of solid angle
    const auto set = [](Row& row, int column, const Vector3d& v) {
        for (int i = 0; i < 3; ++i) row.value[column + i] = static_cast<Scalar>(v[i]);
    };
    const auto add = [&](std::int64_t primitive_id, double power, double area) -> Row& {
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
        Row& row = add(static_cast<std::int64_t>(i), power, 1);
        set(row, Row::kPoint, sphere.center0);
        set(row, Row::kEdgeU, sphere.center1 - sphere.center0);
        row.value[Row::kRadius] = static_cast<Scalar>(sphere.radius);
    }
    for (std::size_t i = 0; i < scene.quads.size(); ++i) {
        const Quad& quad = scene.quads[i];
        const double power = emitted.of(quad);
        const std::size_t id = scene.spheres.size() + i;
        if (power == 0 || is_hidden[id]) continue;
        Row& row = add(static_cast<std::int64_t>(id), power, quad.edge_u.cross(quad.edge_v).norm());
        set(row, Row::kPoint, quad.corner);
        set(row, Row::kEdgeU, quad.edge_u);
        set(row, Row::kEdgeV, quad.edge_v);
    }
    std::size_t count = is_hidden.size();
    bool is_counted = false;  ///< triangles have weights
    for (const MeshShape& shape : scene.meshes) {
        if (scene.is_instance(shape)) continue;
        const std::size_t first = count;
        count += shape.mesh->triangles.size();
        is_counted |= scene.materials[static_cast<std::size_t>(shape.material_id)].kind == Material::Kind::Emissive;
        if (emitted.of(shape, 1) == 0) continue;
        for (std::size_t i = 0; i < shape.mesh->triangles.size(); ++i) {
            const std::array<Vec3<Scalar>, 3> vertex = placed_vertices<Scalar>(shape, i);
            if (!triangle_normal<Scalar>(vertex).allFinite()) continue;
            const Vector3d point = vertex[0].template cast<double>();
            const Vector3d edge_u = vertex[1].template cast<double>() - point;
            const Vector3d edge_v = vertex[2].template cast<double>() - point;
            const double area = edge_u.cross(edge_v).norm() / 2;
            Row& row = add(static_cast<std::int64_t>(first + i), emitted.of(shape, area), area);
            set(row, Row::kPoint, point);
            set(row, Row::kEdgeU, edge_u);
            set(row, Row::kEdgeV, edge_v);
        }
    }
    if (const double power = emitted.of(scene.background); power > 0) add(kNoPrimitive, power, 1);
    if (table.rows.empty()) return table;

    const double sum = std::accumulate(powers.begin(), powers.end(), 0.0);
    for (double& power : powers) power /= sum;
    const std::vector<AliasEntry> entries = alias_table(powers);
    const std::vector<double> chosen = alias_chances(entries, draw_chances<Scalar>(entries.size()));
    table.weights.resize(is_counted ? count : is_hidden.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        Row& row = table.rows[i];
        row.value[Row::kThreshold] = static_cast<Scalar>(entries[i].threshold);
        row.value[Row::kAlias] = of_bits<Scalar>(static_cast<Int<Scalar>>(entries[i].alias));
        const auto primitive_id = bits_of<Scalar>(row.value[Row::kPrimitive]);
        if (primitive_id == kNoPrimitive) {
            table.environment_chance = chosen[i];
        } else if (chosen[i] > 0) {  // else it is found by chance alone
            table.weights[static_cast<std::size_t>(primitive_id)] =
                std::max(static_cast<Scalar>(chosen[i] / areas[i]), std::numeric_limits<Scalar>::min());
        }
    }
    return table;
}

template LightTable<float> light_table(const Scene&, const std::vector<bool>&);
template LightTable<double> light_table(const Scene&, const std::vector<bool>&);

}  // namespace raypool
