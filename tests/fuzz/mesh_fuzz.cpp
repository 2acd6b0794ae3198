/// Any bytes as a mesh: they are refused by an InputError of one line, or make a mesh as mesh.h promises. What begins
/// as a PLY file must is read as one, all else as an OBJ file.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/base/error.h"
#include "core/scene/mesh_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace raypool;

template <class Rows>
bool is_finite(const Rows& rows) {
    return std::all_of(rows.begin(), rows.end(), [](const auto& row) {
        return std::all_of(row.begin(), row.end(), [](float value) { return std::isfinite(value); });
    });
}

void check_mesh(const Mesh& mesh) {
    const std::size_t count = mesh.vertex_count();
    require(!mesh.triangles.empty(), "a mesh has a triangle");
    require(mesh.normals.empty() || mesh.normals.size() == count, "normals are as many as vertices");
    require(mesh.uv.empty() || mesh.uv.size() == count, "uv are as many as vertices");
    require(is_finite(mesh.positions) && is_finite(mesh.normals) && is_finite(mesh.uv), "all numbers are finite");
    for (const Mesh::Triangle& triangle : mesh.triangles) {
        require(std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t index) { return index < count; }),
                "an index names a vertex");
        if (mesh.normals.empty()) continue;
        const auto is_zero = [&](std::uint32_t index) { return mesh.normals[index] == std::array<float, 3>{}; };
        require(std::all_of(triangle.begin(), triangle.end(), is_zero) ||
                    std::none_of(triangle.begin(), triangle.end(), is_zero),
                "all vertices of a triangle have normals or none");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        check_mesh(bytes.starts_with("ply") ? read_ply(bytes, "fuzz.ply") : read_obj(bytes, "fuzz.obj"));
    } catch (const InputError& refusal) {
        require_one_line(refusal.what());
    }
    return 0;
}
