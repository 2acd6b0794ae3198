#include "core/scene/mesh_parser.h"

#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/scene/lengths.h"
#include "core/scene/mesh_reader.h"

namespace raypool {

namespace {

std::array<float, 3> float3(const Vector3d& value) {
    return {static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2])};
}

/// Of a key whose array has an entry for each vertex.
void check_count(const JsonCursor& place, std::size_t vertex_count) {
    if (place.size() != vertex_count)
        place.refuse(fmt::format("hold as many as there are vertices, {}", vertex_count),
                     fmt::format("{}", place.size()));
}

/// The keys "vertices" and "triangles", and "uv" and "normals", which are optional.
Mesh inline_mesh(JsonObject& object) {
    Mesh mesh;
    const JsonCursor vertices = object.required("vertices");
    mesh.positions.reserve(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) mesh.positions.push_back(float3(position(vertices.item(i))));

    const JsonCursor triangles = object.required("triangles");
    if (triangles.size() == 0) triangles.refuse("hold a triangle", "none");
    const auto last = static_cast<std::int64_t>(vertices.size()) - 1;
    mesh.triangles.reserve(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const JsonCursor place = triangles.item(i);
        if (place.size() != 3) place.refuse("be an array of 3 numbers of vertices", fmt::format("{}", place.size()));
        std::array<std::uint32_t, 3>& triangle = mesh.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) triangle[k] = static_cast<std::uint32_t>(place.item(k).integer(0, last));
    }

    if (const auto uv = object.optional("uv")) {
        check_count(*uv, vertices.size());
        for (std::size_t i = 0; i < uv->size(); ++i) {
            const JsonCursor place = uv->item(i);
            constexpr double kMost = 1e6;
            if (place.size() != 2) place.refuse("be an array of 2 numbers: u, v", fmt::format("{}", place.size()));
            mesh.uv.push_back({static_cast<float>(place.item(0).number(-kMost, kMost)),
                               static_cast<float>(place.item(1).number(-kMost, kMost))});
        }
    }
    if (const auto normals = object.optional("normals")) {
        check_count(*normals, vertices.size());
        for (std::size_t i = 0; i < normals->size(); ++i)
            mesh.normals.push_back(float3(direction(normals->item(i)).normalized()));
    }
    return mesh;
}

Mesh mesh_of_file(const JsonCursor& place, const SceneImages& files) {
    const std::filesystem::path file = files.path(place);
    try {
        return read_mesh(file);
    } catch (const InputError& broken) {
        place.refuse("name a PLY or OBJ file that can be read", broken.what());
    }
}

/// {"scale", "rotate", "translate"}: what is given, in this order.
Eigen::Affine3d parse_transform(JsonObject object) {
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    if (const auto scale = object.optional("scale")) {
        Vector3d factors;
        if (scale->is_array()) {
            factors = position(*scale);
            if (factors.cwiseAbs().minCoeff() < kMinLength) scale->refuse("not make a mesh flat", "a factor of 0");
        } else {
            factors = Vector3d::Constant(scale->number(kMinLength, kMaxLength));
        }
        transform = Eigen::Scaling(factors);
    }
    if (const auto rotate = object.optional("rotate")) {
        JsonObject turn(*rotate);
        const Vector3d axis = direction(turn.required("axis"));
        const double degrees = turn.required("degrees").number(-360, 360);
        turn.refuse_unknown_keys();
        transform = Eigen::AngleAxisd(degrees / 180 * std::numbers::pi, axis.normalized()) * transform;
    }
    if (const auto translate = object.optional("translate"))
        transform = Eigen::Translation3d(position(*translate)) * transform;
    object.refuse_unknown_keys();
    return transform;
}

std::shared_ptr<const Mesh> mesh_by_keys(JsonObject& object, const SceneImages& files) {
    const auto file = object.optional("file");
    return std::make_shared<const Mesh>(file ? mesh_of_file(*file, files) : inline_mesh(object));
}

/// By the key "transform", which is optional. `positions` are those of the mesh, or others that hold them all.
void place(JsonObject& object, MeshShape& shape, std::span<const std::array<float, 3>> positions) {
    if (const auto transform = object.optional("transform"))
        shape.transform = parse_transform(JsonObject(*transform)).affine();
    for (const auto& position : positions) {
        const Vector3d placed = shape.placed(position);
        if (!(placed.cwiseAbs().maxCoeff() <= kMaxLength))
            object.place().refuse(fmt::format("keep its vertices within {:g}", kMaxLength),
                                  fmt::format("[{:g}, {:g}, {:g}]", placed[0], placed[1], placed[2]));
    }
}

}  // namespace

MeshShape parse_mesh(JsonObject& object, const SceneImages& files) {
    MeshShape shape{mesh_by_keys(object, files)};
    place(object, shape, shape.mesh->positions);
    return shape;
}

MeshObject parse_object(JsonObject object, const SceneImages& files) {
    object.required("type").one_of({"mesh"});
    MeshObject made{mesh_by_keys(object, files), {}};
    made.corners = made.mesh->box().corners();
    object.refuse_unknown_keys();
    return made;
}

MeshShape parse_instance(JsonObject& object, const MeshObject& of) {
    MeshShape shape{of.mesh};
    shape.is_instance = true;
    place(object, shape, of.corners);
    return shape;
}

}  // namespace raypool
