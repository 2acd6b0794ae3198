#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/scene/mesh_reader.h"
#include "core/scene/ply_header.h"
#include "core/scene/ply_sources.h"

namespace raypool {
namespace {

/// The values of a vertex that a mesh takes lie in this order.
constexpr int kPosition = 0, kNormal = 3, kUv = 6, kVertexValues = 8;
constexpr int kSkipped = -1;

/// What the properties mean.
struct PlyLayout {
    std::vector<int> vertex_values;  ///< for each property of a vertex: which value it is, or kSkipped
    bool has_normals = false;
    bool has_uv = false;
    std::size_t corners = 0;  ///< which property of a face lists its corners
};

/// Finds the layout of one header. It refuses a property that stands twice only if a mesh takes it.
class PlyLayoutFinder {
  public:
    PlyLayoutFinder(const PlyHeader& header, std::string_view name)
        : vertex_(*header.find("vertex")), face_(*header.find("face")), name_(name) {}

    PlyLayout find() {
        layout_.vertex_values.assign(vertex_.properties.size(), kSkipped);
        if (take({"x", "y", "z"}, kPosition) < 3) refuse("element vertex must have properties x, y and z");

        const std::size_t normal_count = take({"nx", "ny", "nz"}, kNormal);
        layout_.has_normals = normal_count == 3;
        if (normal_count % 3 != 0) refuse("element vertex must have all of the properties nx, ny and nz or none");

        using Names = std::initializer_list<std::string_view>;
        for (const Names pair : {Names{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}) {
            layout_.has_uv = layout_.has_uv || take(pair, kUv) == 2;
        }

        auto corners = index_of(face_, "vertex_indices");
        const auto other_name = index_of(face_, "vertex_index");
        if (corners.has_value() == other_name.has_value()) {
            refuse("element face must have one property vertex_indices or vertex_index");
        }
        layout_.corners = corners ? *corners : *other_name;
        const PlyProperty& list = face_.properties[layout_.corners];
        if (!list.count_type || !traits(list.type).is_whole) {
            refuse(fmt::format("property {} must be a list of a whole type", list.name));
        }
        return layout_;
    }

  private:
    /// Takes the properties as the values from `first` on, if all are there. Returns how many are.
    std::size_t take(std::initializer_list<std::string_view> properties, int first) {
        std::vector<std::size_t> found;
        for (const std::string_view property : properties) {
            if (const auto index = index_of(vertex_, property)) found.push_back(*index);
        }
        for (std::size_t i = 0; i < found.size() && found.size() == properties.size(); ++i) {
            if (const PlyProperty& property = vertex_.properties[found[i]]; property.count_type) {
                refuse(fmt::format("property {} must not be a list", property.name));
            }
            layout_.vertex_values[found[i]] = first + static_cast<int>(i);
        }
        return found.size();
    }
    [[nodiscard]] std::optional<std::size_t> index_of(const PlyElement& element, std::string_view property) const {
        std::optional<std::size_t> found;
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            if (element.properties[i].name != property) continue;
            if (found) refuse(fmt::format("element {} must have property {} once", element.name, property));
            found = i;
        }
        return found;
    }
    [[noreturn]] void refuse(std::string_view reason) const { throw InputError(fmt::format("{}: {}", name_, reason)); }

    const PlyElement &vertex_, &face_;
    std::string_view name_;
    PlyLayout layout_;
};

template <class Source>
void skip_property(Source& source, const PlyProperty& property) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    source.skip(property, property.count_type ? source.whole_number(*property.count_type, property.name, 0, kMost) : 1);
}

template <class Source>
void read_vertices(Source& source, const PlyElement& element, const PlyLayout& layout, Mesh& mesh) {
    const auto count = static_cast<std::size_t>(element.count);
    mesh.positions.reserve(count);
    if (layout.has_normals) mesh.normals.reserve(count);
    if (layout.has_uv) mesh.uv.reserve(count);

    std::array<float, kVertexValues> values{};
    for (std::int64_t i = 0; i < element.count; ++i) {
        source.begin(element, i);
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const int value = layout.vertex_values[p];
            if (value == kSkipped) {
                skip_property(source, element.properties[p]);
            } else {
                values[static_cast<std::size_t>(value)] = source.number(element.properties[p]);
            }
        }
        if (layout.has_normals && values[kNormal] == 0 && values[kNormal + 1] == 0 && values[kNormal + 2] == 0)
            source.refuse("nx, ny and nz must not all be 0");
        source.end();
        mesh.positions.push_back({values[kPosition], values[kPosition + 1], values[kPosition + 2]});
        if (layout.has_normals) mesh.normals.push_back({values[kNormal], values[kNormal + 1], values[kNormal + 2]});
        if (layout.has_uv) mesh.uv.push_back({values[kUv], values[kUv + 1]});
    }
}

template <class Source>
void read_corners(Source& source, const PlyProperty& list, std::int64_t vertex_count, Mesh& mesh) {
    const std::int64_t count = source.whole_number(*list.count_type, "the number of corners", 3, kMaxMeshCount);
    if (count - 2 > kMaxMeshCount - std::ssize(mesh.triangles)) {
        source.refuse(fmt::format("there must be at most {} triangles", kMaxMeshCount));
    }
    Mesh::Fan fan(mesh.triangles);
    for (std::int64_t i = 0; i < count; ++i) {
        fan.add(static_cast<std::uint32_t>(source.whole_number(list.type, list.name, 0, vertex_count - 1)));
    }
}

template <class Source>
void read_faces(Source& source, const PlyElement& element, const PlyLayout& layout, std::int64_t vertex_count,
                Mesh& mesh) {
    mesh.triangles.reserve(static_cast<std::size_t>(element.count));
    for (std::int64_t i = 0; i < element.count; ++i) {
        source.begin(element, i);
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            if (p == layout.corners) {
                read_corners(source, element.properties[p], vertex_count, mesh);
            } else {
                skip_property(source, element.properties[p]);
            }
        }
        source.end();
    }
}

template <class Source>
void skip_element(Source& source, const PlyElement& element) {
    if (element.properties.empty()) return;  // nothing stands for it in the file
    for (std::int64_t i = 0; i < element.count; ++i) {
        source.begin(element, i);
        for (const PlyProperty& property : element.properties) skip_property(source, property);
        source.end();
    }
}

template <class Source>
Mesh read_elements(Source source, const PlyHeader& header, const PlyLayout& layout) {
    const std::int64_t vertex_count = header.find("vertex")->count;
    Mesh mesh;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex") {
            read_vertices(source, element, layout, mesh);
        } else if (element.name == "face") {
            read_faces(source, element, layout, vertex_count, mesh);
        } else {
            skip_element(source, element);
        }
    }
    source.expect_end();
    return mesh;
}

}  // namespace

Mesh read_ply(std::string_view bytes, std::string_view name) {
    const PlyHeader header = parse_ply_header(bytes, name);
    const PlyLayout layout = PlyLayoutFinder(header, name).find();
    switch (header.format) {
        case PlyFormat::Ascii:
            return read_elements(PlyTextSource(bytes, name, header), header, layout);
        case PlyFormat::BinaryLittleEndian:
            return read_elements(PlyBinarySource<std::endian::little>(bytes, name, header), header, layout);
        case PlyFormat::BinaryBigEndian:
            break;
    }
    return read_elements(PlyBinarySource<std::endian::big>(bytes, name, header), header, layout);
}

}  // namespace raypool
