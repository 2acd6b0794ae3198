/// What an OBJ file may say, and the exact words with which the rest is refused.
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/core/scene/mesh_samples.h"

namespace raypool {
namespace {

using namespace mesh_samples;

Mesh obj(const std::string& text) {
    return read_obj(text, "a.obj");
}

std::string obj_refusal(const std::string& text) {
    return refusal([&] { obj(text); });
}

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(MeshObj, ReadsPositionsAndTriangles) {
    Mesh expected;
    expected.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
    expected.triangles = {{0, 1, 2}, {2, 1, 0}};
    expect_same(obj(kCorners + "f 1 2 3\nf 3 2 1"), expected);
    expect_same(obj(crlf(kCorners + "f 1 2 3\nf 3 2 1\n")), expected);
    expect_same(obj(kCorners + "\n \t\n#f 4 4 4\n  #\n  f\t1  2 3 \nf -2 -3 -4\n"), expected);
}

TEST(MeshObj, NumbersVerticesByTheirFirstUse) {
    Mesh expected;
    expected.positions = {{0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
    expected.triangles = {{0, 1, 2}, {2, 3, 0}};
    expect_same(obj(kCorners + "f 4 1 2\nf 2 3 4\n"), expected);
}

TEST(MeshObj, SplitsVerticesWhoseNormalsOrUvDiffer) {
    const std::string more = "vt 0 0.5\nvt 1\nvn 0 0 1\nvn 0 0 2\n";
    const Mesh mesh = obj(kCorners + more + "f 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/2/1 4/1/2\nf 1/1/2 3/2/1 4/1/2\n");
    EXPECT_EQ(mesh.positions, (std::vector<Row3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}}));
    EXPECT_EQ(mesh.uv, (std::vector<Row2>{{0, 0.5F}, {0, 0.5F}, {0, 0.5F}, {1, 0}, {0, 0.5F}, {0, 0.5F}}));
    EXPECT_EQ(mesh.normals, (std::vector<Row3>{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 2}, {0, 0, 2}}));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 3, 4}, {5, 3, 4}}));
}

TEST(MeshObj, WhatACornerOrAFaceLeavesOutIsZero) {
    const std::string more = "vt 0.25 0.5 0\nvn 0 0 1\n";
    const Mesh mesh = obj(kCorners + more + "f 1 2/1 3\nf 4/-1/-1 1//1 2//1\n");
    EXPECT_EQ(mesh.uv, (std::vector<Row2>{{0, 0}, {0.25F, 0.5F}, {0, 0}, {0.25F, 0.5F}, {0, 0}, {0, 0}}));
    EXPECT_EQ(mesh.normals, (std::vector<Row3>{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}}));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
    EXPECT_TRUE(obj(kCorners + more + "f 1 2 3\n").uv.empty());
    EXPECT_TRUE(obj(kCorners + more + "f 1/1 2/1 3/1\n").normals.empty());
}

TEST(MeshObj, MakesFansOfPolygonsAroundTheFirstCorner) {
    EXPECT_EQ(obj(kCorners + "f 2 3 4 1\n").triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(obj(kCorners + "f 1 2 \\\n 3\t\\\r\n4 \\\n\n").triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MeshObj, SkipsWhatChangesNoTriangle) {
    const std::string all =
        "mtllib absent.mtl\no \xff\ng a \\\nb\ns off\nusemtl b\nv 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nvp 1 2\np "
        "1\nl 1 2\nlod "
        "1\nmg 1 2\nf 1 2 3\nbevel on\nusemap off\n";
    EXPECT_EQ(obj(all).positions, (std::vector<Row3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(MeshObj, ReadsNumbersAsPlyDoes) {
    const auto x = [](const std::string& word) { return obj("v " + word + " 0 0\nf 1 1 1\n").positions[0][0]; };
    EXPECT_EQ(x("+.5"), 0.5F);
    EXPECT_EQ(x("-1E+2"), -100.0F);
    EXPECT_EQ(x("1.00000017881393432617187501"), 1.0000002384185791015625F);
    EXPECT_EQ(x("-1e-45"), -std::numeric_limits<float>::denorm_min());
    EXPECT_EQ(x("1e-300"), 0.0F);
}

TEST(MeshObj, UnifiesManyVerticesAsAFileWithFewer) {
    std::string text;  // a strip whose corners each have a uv of their own, each used by up to three triangles
    constexpr int kCount = 3000;
    for (int i = 0; i < kCount; ++i) text += "v " + std::to_string(i / 2) + " " + std::to_string(i % 2) + " 0\n";
    for (int i = 0; i < kCount; ++i) text += "vt " + std::to_string(i) + " 0\n";
    for (int i = 1; i + 1 < kCount; ++i) {
        text += "f";
        for (int j = i; j < i + 3; ++j) text += " " + std::to_string(j) + "/" + std::to_string(kCount + 1 - j);
        text += "\n";
    }
    const Mesh mesh = obj(text);
    ASSERT_EQ(mesh.vertex_count(), static_cast<std::size_t>(kCount));
    ASSERT_EQ(mesh.triangle_count(), static_cast<std::size_t>(kCount - 2));
    for (std::uint32_t i = 0; i < kCount; ++i) {
        EXPECT_EQ(mesh.positions[i], (Row3{static_cast<float>(i / 2), static_cast<float>(i % 2), 0}));
        EXPECT_EQ(mesh.uv[i][0], static_cast<float>(kCount - 1 - i));
    }
    for (std::uint32_t i = 0; i + 2 < kCount; ++i) {
        EXPECT_EQ(mesh.triangles[i], (Triangle{i, i + 1, i + 2}));
    }
}

TEST(MeshObj, KeepsCornersOfOnePositionApartByTheirNormals) {
    std::string text = "v 0 0 0\n";
    constexpr int kCount = 1500;
    for (int i = 1; i <= kCount; ++i) text += "vn 0 0 " + std::to_string(i) + "\n";
    for (int i = 1; i <= kCount; i += 3) text += fmt::format("f 1//{} 1//{} 1//{}\n", i, i + 1, i + 2);
    const Mesh mesh = obj(text + text.substr(text.find('f')));
    ASSERT_EQ(mesh.vertex_count(), static_cast<std::size_t>(kCount));
    for (int i = 0; i < kCount; ++i) EXPECT_EQ(mesh.normals[i][2], static_cast<float>(i + 1));
}

TEST(MeshObj, RefusesWhatIsWrongNamingTheLine) {
    const std::string finite = " must be a finite number within single precision, got ";
    const std::string whole = " must be a whole number within [-2147483647, 2147483647], got ";
    const std::pair<std::string, std::string> cases[] = {
        {"", "5: the file must have a face"},
        {"f 1 2\n", "5: a face must have at least 3 corners, got 2"},
        {"f\n", "5: a face must have at least 3 corners, got 0"},
        {"f 1 2 5\n", "5: v 5 is not among the 4 before this line"},
        {"f 1 2 5\nv 0 0 0\n", "5: v 5 is not among the 4 before this line"},
        {"f 1 2 0\n", "5: v 0 is not among the 4 before this line"},
        {"f 1 2 -5\n", "5: v -5 is not among the 4 before this line"},
        {"f 1 2 4294967297\n", "5: v" + whole + "\"4294967297\""},
        {"f 1 2 99999999999999999999\n", "5: v" + whole + "\"99999999999999999999\""},
        {"f 1 2 x\n", "5: v" + whole + "\"x\""},
        {"f 1 2 3.9\n", "5: v" + whole + "\"3.9\""},
        {"f 1 2 3/1\n", "5: vt 1 is not among the 0 before this line"},
        {"f 1 2 3//-1\n", "5: vn -1 is not among the 0 before this line"},
        {"f 1 2 3//x\n", "5: vn" + whole + "\"x\""},
        {"f 1 2 3/\n", "5: an index of vt is missing"},
        {"f 1 2 3/ 1\n", "5: an index of vt is missing"},
        {"f 1 2 3// 1\n", "5: an index of vn is missing"},
        {"vt 0\nf 1 2 3/1/\n", "6: an index of vn is missing"},
        {"vt 0\nf 1 2 3/0\n", "6: vt 0 is not among the 1 before this line"},
        {"vt 0\nvn 0 0 1\nf 1 2 3/1/1/1\n", "7: a corner must be v, v/vt, v//vn or v/vt/vn"},
        {"v 1 2\n", "5: z is missing"},
        {"v nan 0 0\n", "5: x" + finite + "\"nan\""},
        {"v 0 1e39 0\n", "5: y" + finite + "\"1e39\""},
        {"v 0 0 x\n", "5: z" + finite + "\"x\""},
        {"v 0 0 0/1\n", "5: z" + finite + "\"0/1\""},
        {"v 0 0 0 x\n", "5: a weight or a colour" + finite + "\"x\""},
        {"vn 0 0\n", "5: z is missing"},
        {"vn 0 0 inf\n", "5: z" + finite + "\"inf\""},
        {"vn 0 0 1 1\n", "5: the line must end before \"1\""},
        {"vn 0 -0 0\n", "5: a normal must not be 0 0 0"},
        {"vn 0 0 1\nf 1//1 2//1 3\n", "6: all corners of a face must have a vn, or none"},
        {"vt 0\nvn 0 0 1\nf 1/1 2/1 3/1/1\n", "7: all corners of a face must have a vn, or none"},
        {"vt\n", "5: u is missing"},
        {"vt 0 nan\n", "5: v" + finite + "\"nan\""},
        {"vt 0 0 0 0\n", "5: the line must end before \"0\""},
        {"surf 0 1\n", "5: \"surf\" is no statement that can be read"},
        {"call other.obj\n", "5: \"call\" is no statement that can be read"},
        {"F 1 2 3\n", "5: \"F\" is no statement that can be read"},
        {"f 1 2 \\ 3\n", "5: v" + whole + "\"\\\""},
        {std::string("f 1 2 \0 3\n", 10), "5: v" + whole + "\"\\x00\""},
    };
    for (const auto& [text, reason] : cases) EXPECT_EQ(obj_refusal(kCorners + text), "a.obj:" + reason) << text;
}

}  // namespace
}  // namespace raypool
