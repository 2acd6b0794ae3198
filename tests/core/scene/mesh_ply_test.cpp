/// What a PLY file may say, in text and in both byte orders.
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/core/scene/mesh_samples.h"

namespace raypool {
namespace {

using namespace mesh_samples;

constexpr std::endian kOrders[] = {std::endian::little, std::endian::big};

TEST(MeshPly, ReadsText) {
    expect_same(read_ply(kAsciiSquare, "a.ply"), square());
    expect_same(read_ply(crlf(kAsciiSquare), "a.ply"), square());
    expect_same(read_ply(kAsciiSquare.substr(0, kAsciiSquare.size() - 1), "a.ply"), square());
    expect_same(read_ply(with(kAsciiSquare, "1 0 0\n1 1", "\n\t+1   0 \t 0 \n  \n1 1"), "a.ply"), square());
}

TEST(MeshPly, ReadsBothByteOrders) {
    Mesh expected;
    expected.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    expected.triangles = {{0, 1, 2}};
    for (const std::endian order : kOrders) {
        expect_same(read_ply(binary_triangle(order), "a.ply"), expected);
        const std::string file = binary_triangle(order);
        const std::size_t data = file.find("end_header\n") + 11;
        expect_same(read_ply(crlf(file.substr(0, data)) + file.substr(data), "a.ply"), expected);
    }
}

TEST(MeshPly, ReadsEveryTypeByBothOfItsNames) {
    const auto check = [](const std::string& type, std::string_view other_name, auto least, auto most) {
        using Value = decltype(least);
        const std::string rest = "element vertex 3\nproperty " + type + " x\nproperty " + std::string(other_name) +
                                 " y\nproperty " + type +
                                 " z\nelement face 1\nproperty list uchar uchar vertex_index\n";
        for (const std::endian order : kOrders) {
            BinaryData data(order);
            data.add(least).add(most).template add<Value>(7);
            data.template add_all<Value>(1, 2, 3, 4, 5, 6).template add_all<std::uint8_t>(3, 2, 1, 0);
            const Mesh mesh = read_ply(binary_header(order, rest) + data.bytes(), "a.ply");
            EXPECT_EQ(mesh.positions, (std::vector<Row3>{{float(least), float(most), 7}, {1, 2, 3}, {4, 5, 6}}))
                << type;
            EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{2, 1, 0}})) << type;
        }
    };
    const auto check_limits = [&]<class Value>(const std::string& type, std::string_view other_name, Value) {
        check(type, other_name, std::numeric_limits<Value>::lowest(), std::numeric_limits<Value>::max());
    };
    check_limits("char", "int8", std::int8_t());
    check_limits("uchar", "uint8", std::uint8_t());
    check_limits("short", "int16", std::int16_t());
    check_limits("ushort", "uint16", std::uint16_t());
    check_limits("int", "int32", std::int32_t());
    check_limits("uint", "uint32", std::uint32_t());
    check_limits("float", "float32", float());
    check("double", "float64", -1.0 / 3, 1e38);
}

TEST(MeshPly, ReadsListsOfEveryWholeType) {
    const auto check = [](std::string_view type, auto value) {
        using Value = decltype(value);
        const std::string rest =
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list " +
            std::string(type) + " " + std::string(type) + " vertex_indices\n";
        for (const std::endian order : kOrders) {
            BinaryData data(order);
            data.add_all<float>(0, 0, 0, 1, 0, 0, 0, 1, 0).add_all<Value>(3, 0, 1, 2);
            EXPECT_EQ(read_ply(binary_header(order, rest) + data.bytes(), "a.ply").triangles,
                      (std::vector<Triangle>{{0, 1, 2}}))
                << type;
        }
    };
    check("char", std::int8_t());
    check("uchar", std::uint8_t());
    check("short", std::int16_t());
    check("ushort", std::uint16_t());
    check("int", std::int32_t());
    check("uint", std::uint32_t());
}

TEST(MeshPly, MakesFansOfPolygonsAroundTheFirstCorner) {
    const std::string quad = with(with(kAsciiSquare, "face 2", "face 1"), "3 0 1 2\n3 0 2 3\n", "4 1 2 3 0\n");
    EXPECT_EQ(read_ply(quad, "a.ply").triangles, (std::vector<Triangle>{{1, 2, 3}, {1, 3, 0}}));
    const std::string mixed = with(kAsciiSquare, "3 0 2 3\n", "6 0 1 2 3 2 1\n");
    EXPECT_EQ(read_ply(mixed, "a.ply").triangles,
              (std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}, {0, 3, 2}, {0, 2, 1}}));
}

TEST(MeshPly, ReadsNormalsAndEachPairOfNamesForUv) {
    const char* const pairs[][2] = {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
    for (const auto& [u, v] : pairs) {
        for (const std::endian order : kOrders) {
            const std::string rest = std::string("element vertex 3\nproperty float ") + v +
                                     "\nproperty float nz\nproperty float x\nproperty float y\nproperty float z\n"
                                     "property float ny\nproperty float nx\nproperty float " +
                                     u + "\nelement face 1\nproperty list uchar int vertex_indices\n";
            BinaryData data(order);
            for (const int i : {0, 10, 20}) data.add_all<float>(i, i + 1, i + 2, i + 3, i + 4, i + 5, i + 6, i + 7);
            data.add<std::uint8_t>(3).add_all<std::int32_t>(0, 1, 2);
            const Mesh mesh = read_ply(binary_header(order, rest) + data.bytes(), "a.ply");
            EXPECT_EQ(mesh.positions, (std::vector<Row3>{{2, 3, 4}, {12, 13, 14}, {22, 23, 24}}));
            EXPECT_EQ(mesh.normals, (std::vector<Row3>{{6, 5, 1}, {16, 15, 11}, {26, 25, 21}}));
            EXPECT_EQ(mesh.uv, (std::vector<Row2>{{7, 0}, {17, 10}, {27, 20}})) << u;
        }
    }
}

TEST(MeshPly, TakesTheFirstPairOfUvAndSkipsHalfAPair) {
    std::string two =
        with(kAsciiSquare, "property float z\n", "property float z\nproperty float t\nproperty float u\n");
    two = with(two, "0 0 0\n1 0 0\n1 1 -2.5e-1\n0 1 1e-40\n", "0 0 0 8 9\n1 0 0 8 9\n1 1 1 8 9\n0 1 0 8 9\n");
    EXPECT_TRUE(read_ply(two, "a.ply").uv.empty());
    const std::string whole = with(two, "float x\nproperty float y\n", "float v\nproperty float y\n");
    EXPECT_EQ(refusal([&] { read_ply(whole, "a.ply"); }), "a.ply: element vertex must have properties x, y and z");
    const std::string both =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float s\nproperty float t\n"
        "property float u\nproperty float v\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list int int vertex_index\nend_header\n1 2 3 4 5 6 7\n3 0 0 0\n";
    EXPECT_EQ(read_ply(both, "a.ply").uv, (std::vector<Row2>{{3, 4}}));
    EXPECT_EQ(read_ply(both, "a.ply").positions, (std::vector<Row3>{{5, 6, 7}}));
}

TEST(MeshPly, NormalsHaveAnyLength) {
    std::string file =
        with(kAsciiSquare, "float z\n", "float z\nproperty float nx\nproperty float ny\nproperty int nz\n");
    file = with(file, "0 0 0\n1 0 0\n1 1 -2.5e-1\n0 1 1e-40\n",
                "0 0 0 0 0 1\n1 0 0 0 1e-40 0\n1 1 1 0 0 -2\n0 1 0 9 0 0\n");
    EXPECT_EQ(read_ply(file, "a.ply").normals, (std::vector<Row3>{{0, 0, 1}, {0, 1e-40F, 0}, {0, 0, -2}, {9, 0, 0}}));
}

TEST(MeshPly, SkipsOtherElementsAndProperties) {
    const std::string rest =
        "obj_info made up\n"
        "element camera 2\nproperty list ushort double path\nproperty char kind\nelement nothing 1000000000000\n"
        "element face 2\nproperty float quality\nproperty list uint short vertex_indices\n"
        "property list uchar float texcoord\ncomment between\n"
        "element vertex 3\nproperty uchar red\nproperty float x\nproperty list uchar uchar tags\nproperty float y\n"
        "property double z\nproperty ushort group\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n";
    Mesh expected;
    expected.positions = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    expected.triangles = {{2, 1, 0}, {0, 1, 2}, {0, 2, 1}};
    for (const std::endian order : kOrders) {
        BinaryData data(order);
        data.add<std::uint16_t>(3).add_all<double>(1, 2, 3).add<std::int8_t>(-1).add<std::uint16_t>(0).add<std::int8_t>(
            1);
        data.add<float>(std::numeric_limits<float>::quiet_NaN()).add<std::uint32_t>(3).add_all<std::int16_t>(2, 1, 0);
        data.add<std::uint8_t>(2).add_all<float>(0.5, 0.25);
        data.add<float>(1).add<std::uint32_t>(4).add_all<std::int16_t>(0, 1, 2, 1).add<std::uint8_t>(0);
        for (const int i : {1, 4, 7}) {
            data.add<std::uint8_t>(255)
                .add<float>(static_cast<float>(i))
                .add<std::uint8_t>(static_cast<std::uint8_t>(i));
            for (int tag = 0; tag < i; ++tag) data.add<std::uint8_t>(9);
            data.add<float>(static_cast<float>(i + 1)).add<double>(i + 2).add<std::uint16_t>(1);
        }
        data.add_all<std::int32_t>(0, 1);
        expect_same(read_ply(binary_header(order, rest) + data.bytes(), "a.ply"), expected);
    }
    const std::string text = "ply\nformat ascii 1.0\n" + rest +
                             "end_header\n3 1 2 3 -1\n0 1\nnan 3 2 1 0 2 .5 .25\n1 4 0 1 2 1 0\n"
                             "255 1 1 9 2 3 1\n255 4 4 9 9 9 9 5 6 1\n255 7 7 9 9 9 9 9 9 9 8 9 1\n0 1\n";
    expect_same(read_ply(text, "a.ply"), expected);
}

TEST(MeshPly, ReadsTheNearestFloatOfAText) {
    const auto x = [](const std::string& word) {
        return read_ply(with(kAsciiSquare, "1 0 0\n", word + " 0 0\n"), "a.ply").positions[1][0];
    };
    EXPECT_EQ(x("1.00000017881393432617187499"), 1.00000011920928955078125F);  // just below halfway to the next
    EXPECT_EQ(x("1.00000017881393432617187501"), 1.0000002384185791015625F);
    EXPECT_EQ(x("16777217.000000001"), 16777218.0F);
    EXPECT_EQ(x("3.4028235e38"), std::numeric_limits<float>::max());
    EXPECT_EQ(x("-1e-45"), -std::numeric_limits<float>::denorm_min());
    EXPECT_EQ(x("1e-60"), 0.0F);
    EXPECT_EQ(x("1e-300"), 0.0F);
}

TEST(MeshPly, WhiteSpaceMayFollow) {
    expect_same(read_ply(kAsciiSquare + " \n\r\n", "a.ply"), square());
    EXPECT_EQ(read_ply(binary_triangle() + "\r\n", "a.ply").triangle_count(), 1u);
}

}  // namespace
}  // namespace raypool
