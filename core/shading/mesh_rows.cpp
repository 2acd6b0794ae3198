#include "core/shading/mesh_rows.h"

#include <array>
#include <limits>

namespace raypool {

namespace {

template <class Scalar>
Scalar bits(std::size_t number) {
    return of_bits<Scalar>(static_cast<Int<Scalar>>(number));
}

/// Sets the columns of an instance by which rays get into its object's space, from its transform as it is rounded.
/// `box` holds the object's vertices. In the widest numbers there are, so that only what is stored is rounded.
template <class Scalar>
void set_inverse(const Box& box, InstanceRow<Scalar>& row) {
    using Row = InstanceRow<Scalar>;
    using Wide3 = Eigen::Matrix<long double, 3, 1>;
    Eigen::Matrix<long double, 3, 3> matrix;
    Wide3 offset;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) matrix(i, k) = row.value[Row::kTransform + 4 * i + k];
        offset[i] = row.value[Row::kTransform + 4 * i + 3];
    }
    Eigen::Matrix<long double, 3, 3> inverse = matrix.inverse();
    Wide3 back = -inverse * offset;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) row.value[Row::kInverse + 4 * i + k] = static_cast<Scalar>(inverse(i, k));
        row.value[Row::kInverse + 4 * i + 3] = static_cast<Scalar>(back[i]);
    }
    // As they are stored. What is left of `there and back` is added to the room that ObjectRay derives.
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) inverse(i, k) = row.value[Row::kInverse + 4 * i + k];
        back[i] = row.value[Row::kInverse + 4 * i + 3];
    }
    const Wide3 reach = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).template cast<long double>();
    const Wide3 where = matrix.cwiseAbs() * reach + offset.cwiseAbs();
    const Wide3 left = (inverse * matrix - Eigen::Matrix<long double, 3, 3>::Identity()).cwiseAbs() * reach +
                       (inverse * offset + back).cwiseAbs();
    const Wide3 rounded = inverse.cwiseAbs() * where + back.cwiseAbs();
    constexpr long double kEpsilon = std::numeric_limits<Scalar>::epsilon();
    for (int k = 0; k < 3; ++k)
        row.value[Row::kReach + k] = static_cast<Scalar>(32 * kEpsilon * inverse.col(k).cwiseAbs().maxCoeff());
    row.value[Row::kReach + 3] = static_cast<Scalar>(32 * kEpsilon * rounded.maxCoeff() + 2 * left.maxCoeff());
}

}  // namespace

template <class Scalar>
void MeshRows<Scalar>::add(const MeshShape& shape, std::size_t surface) {
    add(shape, shape.is_mirrored(), surface);  // a transform that mirrors turns triangles over; the outward side stays
}

template <class Scalar>
void MeshRows<Scalar>::add(const MeshShape& shape, bool is_turned, std::size_t surface) {
    const Mesh& mesh = *shape.mesh;
    const std::size_t first_vertex = tables_.vertices.size();
    for (const auto& position : mesh.positions) {
        const Vector3d placed = shape.placed(position);
        VertexRow<Scalar>& row = tables_.vertices.emplace_back(VertexRow<Scalar>{});
        for (int i = 0; i < 3; ++i) row.value[i] = static_cast<Scalar>(placed[i]);
        row.value[VertexRow<Scalar>::kNormal] = of_bits<Scalar>(Int<Scalar>(-1));
    }
    using Triangle = TriangleRow<Scalar>;
    for (const auto& triangle : mesh.triangles) {
        Triangle& row = tables_.triangles.emplace_back(Triangle{});
        for (int i = 0; i < 3; ++i) row.value[Triangle::kVertex + i] = bits<Scalar>(first_vertex + triangle[i]);
        if (is_turned) std::swap(row.value[1], row.value[2]);
        row.value[Triangle::kSurface] = bits<Scalar>(surface);
    }
    add_normals(shape, first_vertex);
    if (mesh.uv.empty()) return;
    tables_.vertex_uv.resize(2 * first_vertex);
    for (const auto& [u, v] : mesh.uv)
        for (const float coordinate : {u, v}) tables_.vertex_uv.push_back(static_cast<Scalar>(coordinate));
}

template <class Scalar>
void MeshRows<Scalar>::add_normals(const MeshShape& shape, std::size_t first_vertex) {
    const Eigen::Matrix3d transform = shape.normal_transform();
    for (std::size_t i = 0; i < shape.mesh->normals.size(); ++i) {
        const auto& [x, y, z] = shape.mesh->normals[i];
        if (x == 0 && y == 0 && z == 0) continue;
        const Vector3d normal = (transform * Vector3d(x, y, z).normalized()).normalized();
        tables_.vertices[first_vertex + i].value[VertexRow<Scalar>::kNormal] =
            bits<Scalar>(tables_.vertex_normals.size() / 3);
        for (int axis = 0; axis < 3; ++axis) tables_.vertex_normals.push_back(static_cast<Scalar>(normal[axis]));
    }
}

template <class Scalar>
const ObjectRows& MeshRows<Scalar>::object(const MeshShape& shape, std::size_t surface) {
    const auto [found, is_new] = object_of_.try_emplace({shape.mesh.get(), shape.is_mirrored()}, objects_.size());
    if (is_new) {
        const auto corner = [](const std::array<float, 3>& p) { return Vector3d(p[0], p[1], p[2]); };
        const Mesh::Box bounds = shape.mesh->box();
        const Box box{corner(bounds.low), corner(bounds.high)};
        objects_.push_back({{static_cast<std::uint32_t>(tables_.triangles.size()),
                             static_cast<std::uint32_t>(shape.mesh->triangles.size())},
                            box});
        add(MeshShape{shape.mesh}, shape.is_mirrored(), surface);
    }
    return objects_[found->second];
}

template <class Scalar>
void MeshRows<Scalar>::add_instance(const MeshShape& shape, std::size_t surface, std::int64_t first_id) {
    using Row = InstanceRow<Scalar>;
    const ObjectRows& rows = object(shape, surface);
    Row& row = tables_.instance_tree.blocks.emplace_back(Row{});
    for (int i = 0; i < 12; ++i) row.value[Row::kTransform + i] = static_cast<Scalar>(shape.transform(i / 4, i % 4));
    row.value[Row::kFirstId] = bits<Scalar>(static_cast<std::size_t>(first_id));
    row.value[Row::kFirstTriangle] = bits<Scalar>(rows.first);
    row.value[Row::kSurface] = bits<Scalar>(surface);
    set_inverse(rows.box, row);
    tables_.instance_first_ids.push_back(row.value[Row::kFirstId]);
}

template <class Scalar>
void MeshRows<Scalar>::finish() {
    if (!tables_.vertex_uv.empty()) tables_.vertex_uv.resize(2 * tables_.vertices.size());
    if (!tables_.vertex_normals.empty()) tables_.vertex_normals.push_back(0);
}

template class MeshRows<float>;
template class MeshRows<double>;

}  // namespace raypool
