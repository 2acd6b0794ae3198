/// The header of a PLY file: which elements follow it, with which properties, in which format.
///
/// The views point into the bytes of the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace raypool {

enum class PlyFormat { Ascii, BinaryLittleEndian, BinaryBigEndian };

enum class PlyType : std::uint8_t { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

/// What a type can hold. A whole type has its range; the others have none.
struct PlyTypeTraits {
    std::string_view name, old_name;
    std::int64_t size;  ///< bytes
    bool is_whole;
    std::int64_t least, most;
};
const PlyTypeTraits& traits(PlyType type);

struct PlyProperty {
    std::string_view name;
    PlyType type = PlyType::Float32;    ///< of the value, or of each in the list
    std::optional<PlyType> count_type;  ///< of a list
    std::int64_t least_length = 0;      ///< of a list: 3 for the corners of a face
};

struct PlyElement {
    std::string_view name;
    std::int64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::Ascii;
    std::vector<PlyElement> elements;  ///< in the file's order
    std::size_t size = 0;              ///< bytes, the end of its last line included

    [[nodiscard]] const PlyElement* find(std::string_view element) const;  ///< null when there is none
};

/// Throws InputErrors as mesh_reader.h says. Elements `vertex` and `face` stand once and have from 1 to kMaxMeshCount
/// members, and all elements fit into the bytes after the header by the least that each can take.
PlyHeader parse_ply_header(std::string_view bytes, std::string_view name);

}  // namespace raypool
