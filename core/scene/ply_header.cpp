#include "core/scene/ply_header.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_text.h"

namespace raypool {
namespace {

template <class Whole>
constexpr PlyTypeTraits whole_type(std::string_view name, std::string_view old_name) {
    using Limits = std::numeric_limits<Whole>;
    return {name, old_name, sizeof(Whole), true, Limits::min(), Limits::max()};
}

constexpr std::array<PlyTypeTraits, 8> kTypes{
    whole_type<std::int8_t>("int8", "char"),           whole_type<std::uint8_t>("uint8", "uchar"),
    whole_type<std::int16_t>("int16", "short"),        whole_type<std::uint16_t>("uint16", "ushort"),
    whole_type<std::int32_t>("int32", "int"),          whole_type<std::uint32_t>("uint32", "uint"),
    PlyTypeTraits{"float32", "float", 4, false, 0, 0}, PlyTypeTraits{"float64", "double", 8, false, 0, 0}};

PlyType take_type(MeshText& text) {
    const std::string_view word = text.word();
    const auto found = std::find_if(kTypes.begin(), kTypes.end(), [&](const PlyTypeTraits& type) {
        return !word.empty() && (type.name == word || type.old_name == word);
    });
    if (found == kTypes.end()) text.refuse(fmt::format("{} is no type of a property", quoted_word(word)));
    return static_cast<PlyType>(found - kTypes.begin());
}

std::string_view take_name(MeshText& text, std::string_view what) {
    const std::string_view word = text.word();
    if (word.empty()) text.refuse(fmt::format("{} is missing", what));
    return word;
}

PlyFormat take_format(MeshText& text) {
    const std::string_view format = text.word(), version = text.word();
    if (version != "1.0") text.refuse(fmt::format("the version must be 1.0, got {}", quoted_word(version)));
    if (format == "ascii") return PlyFormat::Ascii;
    if (format == "binary_little_endian") return PlyFormat::BinaryLittleEndian;
    if (format != "binary_big_endian") {
        text.refuse(fmt::format("the format must be ascii, binary_little_endian or binary_big_endian, got {}",
                                quoted_word(format)));
    }
    return PlyFormat::BinaryBigEndian;
}

bool is_of_mesh(std::string_view element) {
    return element == "vertex" || element == "face";
}

PlyElement take_element(MeshText& text, const PlyHeader& header) {
    PlyElement element;
    element.name = take_name(text, "the name of the element");
    if (is_of_mesh(element.name)) {
        if (header.find(element.name) != nullptr) text.refuse(fmt::format("element {} must stand once", element.name));
        element.count = text.whole_number("the number of elements", 1, kMaxMeshCount);
    } else {
        element.count = text.whole_number("the number of elements", 0, std::numeric_limits<std::int64_t>::max());
    }
    return element;
}

PlyProperty take_property(MeshText& text, const PlyHeader& header) {
    if (header.elements.empty()) text.refuse("a property must follow an element");
    PlyProperty property;
    if (MeshText ahead = text; ahead.word() == "list") {
        text.word();
        property.count_type = take_type(text);
        if (!traits(*property.count_type).is_whole) text.refuse("the length of a list must be of a whole type");
    }
    property.type = take_type(text);
    property.name = take_name(text, "the name of the property");
    const bool is_corners = property.name == "vertex_indices" || property.name == "vertex_index";
    if (is_corners && header.elements.back().name == "face") property.least_length = 3;
    return property;
}

/// The lines after the first, up to end_header.
PlyHeader parse_lines(MeshText& text) {
    PlyHeader header;
    std::optional<PlyFormat> format;
    for (bool is_last = false; !is_last;) {
        text.next_line();
        if (text.at_end()) text.refuse("the header must end with the line \"end_header\"");
        const std::string_view keyword = text.word();
        if (keyword == "comment" || keyword == "obj_info") continue;

        if (keyword == "format") {
            if (format) text.refuse("the format must stand once");
            format = take_format(text);
        } else if (keyword == "element") {
            header.elements.push_back(take_element(text, header));
        } else if (keyword == "property") {
            const PlyProperty property = take_property(text, header);
            header.elements.back().properties.push_back(property);
        } else if (keyword == "end_header") {
            if (!format) text.refuse("the header must tell the format");
            is_last = true;
        } else {
            text.refuse(
                fmt::format("a line of the header must begin with format, comment, obj_info, element, property "
                            "or end_header, got {}",
                            quoted_word(keyword)));
        }
        text.expect_line_end();
    }
    text.next_line();
    header.format = *format;
    header.size = text.offset();
    return header;
}

/// The least that an element takes, in an ascii file with one character after each value.
std::int64_t least_bytes(const PlyElement& element, PlyFormat format) {
    const bool is_ascii = format == PlyFormat::Ascii;
    std::int64_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
        const std::int64_t value = is_ascii ? 2 : traits(property.type).size;
        const std::int64_t count = !property.count_type ? 0 : is_ascii ? 2 : traits(*property.count_type).size;
        bytes += property.count_type ? count + property.least_length * value : value;
    }
    return bytes;
}

void check_size(const PlyHeader& header, std::size_t file_size, std::string_view name) {
    auto left = static_cast<std::int64_t>(file_size - header.size);
    if (header.format == PlyFormat::Ascii) ++left;  // the last line may lack its end
    for (const PlyElement& element : header.elements) {
        const std::int64_t bytes = least_bytes(element, header.format);
        if (bytes > 0 && element.count > left / bytes) {
            throw InputError(
                fmt::format("{}: {} of element {}, of at least {} bytes each, do not fit into the {} bytes "
                            "after the header",
                            name, element.count, quoted_word(element.name), bytes, file_size - header.size));
        }
        left -= element.count * bytes;
    }
}

}  // namespace

const PlyTypeTraits& traits(PlyType type) {
    return kTypes[static_cast<std::size_t>(type)];
}

const PlyElement* PlyHeader::find(std::string_view element) const {
    const auto found =
        std::find_if(elements.begin(), elements.end(), [&](const PlyElement& each) { return each.name == element; });
    return found == elements.end() ? nullptr : &*found;
}

PlyHeader parse_ply_header(std::string_view bytes, std::string_view name) {
    MeshText text(bytes, name);
    if (!bytes.starts_with("ply") || text.word() != "ply" || !text.at_line_end()) {
        throw InputError(fmt::format("{}: not a PLY file: must begin with the line \"ply\"", name));
    }
    PlyHeader header = parse_lines(text);
    for (const std::string_view wanted : {"vertex", "face"}) {
        if (header.find(wanted) == nullptr) throw InputError(fmt::format("{}: must have an element {}", name, wanted));
    }
    check_size(header, bytes.size(), name);
    return header;
}

}  // namespace raypool
