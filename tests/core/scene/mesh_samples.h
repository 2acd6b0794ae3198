/// What tests of mesh files share: PLY files put together from parts, and comparison by bits.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>

#include "core/scene/mesh_reader.h"
#include "tests/core/scene/scene_text.h"

namespace raypool::mesh_samples {

using scene_text::refusal;
using scene_text::with;
using Row2 = std::array<float, 2>;
using Row3 = std::array<float, 3>;
using Triangle = Mesh::Triangle;

/// A square of two triangles with every attribute, and what else a file may hold.
inline const std::string kAsciiSquare =
    "ply\n"
    "format ascii 1.0\n"
    "comment made for a test\n"
    "element vertex 4\n"
    "property float x\n"
    "property float y\n"
    "property float z\n"
    "element face 2\n"
    "property list uchar int vertex_indices\n"
    "end_header\n"
    "0 0 0\n"
    "1 0 0\n"
    "1 1 -2.5e-1\n"
    "0 1 1e-40\n"
    "3 0 1 2\n"
    "3 0 2 3\n";

inline Mesh square() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, -0.25F}, {0, 1, 1e-40F}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

inline std::string crlf(std::string_view text) {
    std::string result;
    for (const char c : text) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
    return result;
}

/// Values one after the other, in a byte order.
class BinaryData {
  public:
    explicit BinaryData(std::endian order) : order_(order) {}
    template <class Value>
    BinaryData& add(Value value) {
        std::array<char, sizeof value> bytes;
        std::memcpy(bytes.data(), &value, sizeof value);
        if (order_ != std::endian::native) std::reverse(bytes.begin(), bytes.end());
        bytes_.append(bytes.data(), bytes.size());
        return *this;
    }
    template <class Value, class... Values>
    BinaryData& add_all(Values... values) {
        (add(static_cast<Value>(values)), ...);
        return *this;
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

  private:
    std::endian order_;
    std::string bytes_;
};

inline std::string binary_header(std::endian order, std::string_view rest) {
    const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
    return "ply\nformat " + format + " 1.0\n" + std::string(rest) + "end_header\n";
}

/// One triangle in the byte order, of vertices that are floats, for tests to spoil.
inline std::string binary_triangle(std::endian order = std::endian::little) {
    BinaryData data(order);
    data.add_all<float>(0, 0, 0, 1, 0, 0, 0, 1, 0).add<std::uint8_t>(3).add_all<std::int32_t>(0, 1, 2);
    return binary_header(order,
                         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                         "element face 1\nproperty list uchar int vertex_indices\n") +
           data.bytes();
}

template <class Row>
bool same_bits(const std::vector<Row>& a, const std::vector<Row>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Row)) == 0);
}

inline void expect_same(const Mesh& mesh, const Mesh& expected) {
    EXPECT_TRUE(same_bits(mesh.positions, expected.positions));
    EXPECT_TRUE(same_bits(mesh.normals, expected.normals));
    EXPECT_TRUE(same_bits(mesh.uv, expected.uv));
    EXPECT_EQ(mesh.triangles, expected.triangles);
}

}  // namespace raypool::mesh_samples
