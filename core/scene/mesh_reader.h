/// Files of triangle meshes: PLY and Wavefront OBJ, read without trusting them.
///
/// PLY 1.0: ascii, binary_little_endian and binary_big_endian, with properties of any type. Element `vertex` has x, y
/// and z; it may have nx, ny and nz (all or none, and no vertex all zero), and one of the pairs (u, v), (s, t),
/// (texture_u, texture_v) and (texture_s, texture_t). Element `face` has one list, vertex_indices or vertex_index.
/// Elements may come in any order. All other elements and properties are skipped. In an ascii file an element is a
/// line. A vertex keeps its place. Format: Greg Turk, "The PLY Polygon File Format", 1994.
///
/// OBJ: v, vt, vn and f, with relative indices and lines that a \ continues. A vertex is a triple v/vt/vn that some
/// face uses, in order of first use. Where only some corners have vt, the others get uv (0, 0). Either all corners of a
/// face have a vn, which is not zero, or none; where only some faces have them, the others' vertices get the normal
/// (0, 0, 0). An index refers to what the lines above define. Materials, groups, lines and points are skipped, and no
/// other file is opened. Curves, surfaces and unknown words are refused.
///
/// In both, a polygon becomes a fan of triangles around its first corner. A file makes a mesh as mesh.h promises, of at
/// least one triangle, or throws an InputError of one line that names the file, the line (of text) or the byte (of
/// binary data, counted from 0), and the reason: positions, normals and uv that are not finite floats among them. What
/// a header claims is checked against the file's size before memory is taken for it. Nothing may follow the last
/// element of a PLY file but white space.
///
/// Memory: the file and the mesh, as long as all faces of a PLY file are triangles. Polygons and OBJ files take up to
/// as much as the mesh again while it grows, and OBJ files their v, vt and vn and 20 to 28 bytes a vertex.
/// Thread-safe: the functions keep no state.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/scene/mesh.h"

namespace raypool {

/// By the extension, .ply or .obj in either case.
Mesh read_mesh(const std::filesystem::path& path);

/// The same from bytes in memory; `name` stands before every refusal.
Mesh read_ply(std::string_view bytes, std::string_view name);
Mesh read_obj(std::string_view bytes, std::string_view name);

}  // namespace raypool
