#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/scene/mesh_reader.h"
#include "core/scene/mesh_text.h"

namespace raypool {
namespace {

/// What a face says of a corner: its place among the v, vt and vn so far, from 1; 0 for a vt or vn that it leaves out.
using ObjCorner = std::array<std::uint32_t, 3>;

/// Numbers corners in order of first use. A hash table with open addressing, at most half full.
class ObjCornerTable {
  public:
    /// The corner's number, and whether it is new.
    std::pair<std::uint32_t, bool> insert(const ObjCorner& corner) {
        if (2 * (corners_.size() + 1) > slots_.size()) grow();
        std::uint32_t& slot = slots_[find_slot(corner)];
        const bool is_new = slot == kFree;
        if (is_new) {
            slot = static_cast<std::uint32_t>(corners_.size());
            corners_.push_back(corner);
        }
        return {slot, is_new};
    }

  private:
    static constexpr std::uint32_t kFree = 0xffffffffU;

    [[nodiscard]] std::size_t find_slot(const ObjCorner& corner) const {
        std::uint64_t hash = 0;
        for (const std::uint32_t part : corner) hash = (hash ^ part) * 0x9e3779b97f4a7c15U, hash ^= hash >> 32U;
        std::size_t slot = hash & (slots_.size() - 1);
        while (slots_[slot] != kFree && corners_[slots_[slot]] != corner) slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }
    void grow() {
        slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), kFree);
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            slots_[find_slot(corners_[i])] = static_cast<std::uint32_t>(i);
        }
    }

    std::vector<std::uint32_t> slots_;  ///< a power of two of them
    std::vector<ObjCorner> corners_;
};

/// Statements without which the triangles are the same.
constexpr std::array<std::string_view, 17> kSkippedStatements{
    "bevel", "c_interp", "d_interp", "g",          "l",         "lod",    "maplib", "mg", "mtllib",
    "o",     "p",        "s",        "shadow_obj", "trace_obj", "usemap", "usemtl", "vp"};

class ObjReader {
  public:
    ObjReader(std::string_view bytes, std::string_view name) : text_(bytes, name, MeshText::Lines::Continued) {}

    Mesh read() {
        for (; !text_.at_end(); text_.next_line()) read_statement();
        if (mesh_.triangles.empty()) text_.refuse("the file must have a face");
        if (!mesh_.normals.empty()) mesh_.normals.resize(mesh_.positions.size());
        if (!mesh_.uv.empty()) mesh_.uv.resize(mesh_.positions.size());
        return std::move(mesh_);
    }

  private:
    void read_statement() {
        if (text_.at_line_end() || text_.take('#')) return;
        const std::string_view word = text_.word();
        if (word == "v") {
            positions_.push_back({text_.number("x"), text_.number("y"), text_.number("z")});
            while (!text_.at_line_end()) text_.number("a weight or a colour");
        } else if (word == "vn") {
            normals_.push_back({text_.number("x"), text_.number("y"), text_.number("z")});
            if (normals_.back() == std::array<float, 3>{}) text_.refuse("a normal must not be 0 0 0");
            text_.expect_line_end();
        } else if (word == "vt") {
            uv_.push_back({text_.number("u"), text_.at_line_end() ? 0.0F : text_.number("v")});
            if (!text_.at_line_end()) text_.number("w");
            text_.expect_line_end();
        } else if (word == "f") {
            read_face();
        } else if (std::find(kSkippedStatements.begin(), kSkippedStatements.end(), word) != kSkippedStatements.end()) {
            while (!text_.at_line_end()) text_.word();
        } else {
            text_.refuse(fmt::format("{} is no statement that can be read", quoted_word(word)));
        }
    }

    void read_face() {
        Mesh::Fan fan(mesh_.triangles);
        bool has_normals = false;
        while (!text_.at_line_end()) {
            if (std::max(std::ssize(mesh_.positions), std::ssize(mesh_.triangles)) == kMaxMeshCount) {
                text_.refuse(fmt::format("there must be at most {} vertices and triangles", kMaxMeshCount));
            }
            const ObjCorner corner = take_corner();
            if (fan.corner_count() == 0) has_normals = corner[2] != 0;
            if (has_normals != (corner[2] != 0)) text_.refuse("all corners of a face must have a vn, or none");
            fan.add(vertex_of(corner));
        }
        if (fan.corner_count() < 3) {
            text_.refuse(fmt::format("a face must have at least 3 corners, got {}", fan.corner_count()));
        }
    }

    /// v, v/vt, v//vn or v/vt/vn.
    ObjCorner take_corner() {
        ObjCorner corner{take_index("v", positions_.size()), 0, 0};
        if (text_.take('/')) {
            if (!text_.take('/')) {
                corner[1] = take_index("vt", uv_.size());
                if (text_.take('/')) corner[2] = take_index("vn", normals_.size());
            } else {
                corner[2] = take_index("vn", normals_.size());
            }
        }
        if (!text_.at_word_end()) text_.refuse("a corner must be v, v/vt, v//vn or v/vt/vn");
        return corner;
    }

    /// The vertex of the mesh, which is new at the corner's first use.
    std::uint32_t vertex_of(const ObjCorner& corner) {
        const auto [vertex, is_new] = corners_.insert(corner);
        if (is_new) {
            mesh_.positions.push_back(positions_[corner[0] - 1]);
            if (corner[1] != 0) {
                mesh_.uv.resize(mesh_.positions.size());
                mesh_.uv.back() = uv_[corner[1] - 1];
            }
            if (corner[2] != 0) {
                mesh_.normals.resize(mesh_.positions.size());
                mesh_.normals.back() = normals_[corner[2] - 1];
            }
        }
        return vertex;
    }

    /// From 1 on; a negative one counts back from the last.
    std::uint32_t take_index(std::string_view what, std::size_t size) {
        if (text_.at_word_end()) text_.refuse(fmt::format("an index of {} is missing", what));
        const auto count = static_cast<std::int64_t>(size);
        const std::int64_t index = text_.whole_number(what, -kMaxMeshCount, kMaxMeshCount, true);
        if (index == 0 || index > count || index < -count) {
            text_.refuse(fmt::format("{} {} is not among the {} before this line", what, index, count));
        }
        return static_cast<std::uint32_t>(index > 0 ? index : count + 1 + index);
    }

    MeshText text_;
    std::vector<std::array<float, 3>> positions_, normals_;
    std::vector<std::array<float, 2>> uv_;
    ObjCornerTable corners_;
    Mesh mesh_;
};

}  // namespace

Mesh read_obj(std::string_view bytes, std::string_view name) {
    return ObjReader(bytes, name).read();
}

}  // namespace raypool
