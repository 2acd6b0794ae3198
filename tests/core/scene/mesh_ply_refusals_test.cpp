/// What is wrong with a PLY file, in the exact words with which it is refused.
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/core/scene/mesh_samples.h"

namespace raypool {
namespace {

using namespace mesh_samples;

std::string ply_refusal(const std::string& bytes) {
    return refusal([&] { read_ply(bytes, "a.ply"); });
}

/// The square with a part that is another.
std::string refusal_with(const std::string& part, const std::string& instead) {
    return ply_refusal(with(kAsciiSquare, part, instead));
}

TEST(MeshPlyRefusals, OfWhatIsNoPly) {
    const std::string reason = "a.ply: not a PLY file: must begin with the line \"ply\"";
    for (const char* text :
         {"", "p", "PLY\n", "plywood\n", " ply\n", "\nply\n", "ply format\n", "ply\rformat ascii 1.0\r"})
        EXPECT_EQ(ply_refusal(text), reason) << text;
    EXPECT_EQ(ply_refusal("ply\n"), "a.ply:2: the header must end with the line \"end_header\"");
    EXPECT_EQ(ply_refusal("ply"), "a.ply:1: the header must end with the line \"end_header\"");
}

TEST(MeshPlyRefusals, OfHeaders) {
    const std::pair<std::pair<std::string, std::string>, std::string> cases[] = {
        {{"ascii", "ASCII"}, ":2: the format must be ascii, binary_little_endian or binary_big_endian, got \"ASCII\""},
        {{"1.0", "1.1"}, ":2: the version must be 1.0, got \"1.1\""},
        {{" 1.0", ""}, ":2: the version must be 1.0, got \"\""},
        {{"1.0", "1.0 x"}, ":2: the line must end before \"x\""},
        {{"format ascii 1.0\n", ""}, ":9: the header must tell the format"},
        {{"comment made for a test", "format ascii 1.0"}, ":3: the format must stand once"},
        {{"comment made", "remark"},
         ":3: a line of the header must begin with format, comment, obj_info, element, property or end_header, got "
         "\"remark\""},
        {{"comment made for a test", ""},
         ":3: a line of the header must begin with format, comment, obj_info, element, property or end_header, got "
         "\"\""},
        {{"comment made for a test", "property int a"}, ":3: a property must follow an element"},
        {{"element vertex 4", "element"}, ":4: the name of the element is missing"},
        {{"element vertex 4", "element vertex"}, ":4: the number of elements is missing"},
        {{"element vertex 4", "element vertex 4 4"}, ":4: the line must end before \"4\""},
        {{"vertex 4", "vertex 0"},
         ":4: the number of elements must be a whole number within [1, 2147483647], got \"0\""},
        {{"vertex 4", "vertex -4"},
         ":4: the number of elements must be a whole number within [1, 2147483647], got \"-4\""},
        {{"vertex 4", "vertex 2147483648"},
         ":4: the number of elements must be a whole number within [1, 2147483647], got \"2147483648\""},
        {{"vertex 4", "vertex 99999999999999999999"},
         ":4: the number of elements must be a whole number within [1, 2147483647], got \"99999999999999999999\""},
        {{"vertex 4", "vertex 4.0"},
         ":4: the number of elements must be a whole number within [1, 2147483647], got \"4.0\""},
        {{"face 2", "face 0"}, ":8: the number of elements must be a whole number within [1, 2147483647], got \"0\""},
        {{"face 2", "other -1"},
         ":8: the number of elements must be a whole number within [0, 9223372036854775807], got \"-1\""},
        {{"element face", "element vertex"}, ":8: element vertex must stand once"},
        {{"float x", "half x"}, ":5: \"half\" is no type of a property"},
        {{"property float x", "property"}, ":5: \"\" is no type of a property"},
        {{"float x", "float"}, ":5: the name of the property is missing"},
        {{"float x", "float x 1"}, ":5: the line must end before \"1\""},
        {{"list uchar", "list float"}, ":9: the length of a list must be of a whole type"},
        {{"list uchar int", "list uchar"}, ":9: \"vertex_indices\" is no type of a property"},
        {{"end_header", "end_header x"}, ":10: the line must end before \"x\""},
        {{"float x", "list uchar float x"}, ": property x must not be a list"},
        {{"float x", "float X"}, ": element vertex must have properties x, y and z"},
        {{"float z", "float z\nproperty int x"}, ": element vertex must have property x once"},
        {{"float z", "float z\nproperty int nx\nproperty int nz"},
         ": element vertex must have all of the properties nx, ny and nz or none"},
        {{"element vertex", "element Vertex"}, ": must have an element vertex"},
        {{"element face", "element tristrips"}, ": must have an element face"},
        {{"vertex_indices", "indices"}, ": element face must have one property vertex_indices or vertex_index"},
        {{"vertex_indices", "vertex_indices\nproperty list int int vertex_index"},
         ": element face must have one property vertex_indices or vertex_index"},
        {{"vertex_indices", "vertex_indices\nproperty int vertex_indices"},
         ": element face must have property vertex_indices once"},
        {{"uchar int", "uchar float"}, ": property vertex_indices must be a list of a whole type"},
        {{"list uchar int", "int"}, ": property vertex_indices must be a list of a whole type"},
    };
    for (const auto& [change, reason] : cases) {
        const std::string room(100, ' ');  // for more properties
        EXPECT_EQ(ply_refusal(with(kAsciiSquare, change.first, change.second) + room), "a.ply" + reason)
            << change.second;
    }
}

TEST(MeshPlyRefusals, OfMoreElementsThanTheFileHasRoomFor) {
    EXPECT_EQ(
        refusal_with("vertex 4", "vertex 1000000000"),
        "a.ply: 1000000000 of element \"vertex\", of at least 6 bytes each, do not fit into the 50 bytes after the "
        "header");
    EXPECT_EQ(refusal_with("face 2", "face 2000000000"),
              "a.ply: 2000000000 of element \"face\", of at least 8 bytes each, do not fit into the 50 bytes after the "
              "header");
    EXPECT_EQ(
        refusal_with("element face", "element a 9223372036854775807\nproperty char b\nelement face"),
        "a.ply: 9223372036854775807 of element \"a\", of at least 2 bytes each, do not fit into the 50 bytes after "
        "the header");
    EXPECT_EQ(
        ply_refusal(with(binary_triangle(), "vertex 3", "vertex 5")),
        "a.ply: 5 of element \"vertex\", of at least 12 bytes each, do not fit into the 49 bytes after the header");
    EXPECT_EQ(ply_refusal(with(binary_triangle(), "face 1", "face 2")),
              "a.ply: 2 of element \"face\", of at least 13 bytes each, do not fit into the 49 bytes after the header");
    EXPECT_EQ(
        ply_refusal(with(binary_triangle(), "element face", "element a 99\nproperty list int char b\nelement face")),
        "a.ply: 99 of element \"a\", of at least 4 bytes each, do not fit into the 49 bytes after the header");
}

TEST(MeshPlyRefusals, OfTextData) {
    const std::string index = "vertex_indices must be a whole number within [0, 3], got ";
    const std::pair<std::pair<std::string, std::string>, std::string> cases[] = {
        {{"1 0 0\n", "1 0\n"}, ":12: z is missing"},
        {{"1 0 0\n", "1 0 0 0\n"}, ":12: the line must end before \"0\""},
        {{"1 0 0\n", "nan 0 0\n"}, ":12: x must be a finite number within single precision, got \"nan\""},
        {{"1 0 0\n", "0 -inf 0\n"}, ":12: y must be a finite number within single precision, got \"-inf\""},
        {{"1 0 0\n", "0 0 3.5e38\n"}, ":12: z must be a finite number within single precision, got \"3.5e38\""},
        {{"1 0 0\n", "0 0 1e999\n"}, ":12: z must be a finite number within single precision, got \"1e999\""},
        {{"1 0 0\n", "1e-999 0 0\n"}, ":12: x must be a finite number within single precision, got \"1e-999\""},
        {{"1 0 0\n", "1,0 0 0\n"}, ":12: x must be a finite number within single precision, got \"1,0\""},
        {{"1 0 0\n", "0x1 0 0\n"}, ":12: x must be a finite number within single precision, got \"0x1\""},
        {{"1 0 0\n", "1e 0 0\n"}, ":12: x must be a finite number within single precision, got \"1e\""},
        {{"1 0 0\n", "+-1 0 0\n"}, ":12: x must be a finite number within single precision, got \"+-1\""},
        {{"1 0 0\n", "1\x1b[31m 0 0\n"}, ":12: x must be a finite number within single precision, got \"1\\x1b[31m\""},
        {{"1 0 0\n", std::string(5000, 'x') + " 0 0\n"},
         ":12: x must be a finite number within single precision, got \"" + std::string(40, 'x') + "...\""},
        {{"float x\nproperty float y", "char x\nproperty char y"}, ""},
        {{"float x", "uchar x"}, ""},
        {{"float z", "uchar z"}, ":13: z must be a whole number within [0, 255], got \"-2.5e-1\""},
        {{"3 0 1 2", "2 0 1"}, ":15: the number of corners must be a whole number within [3, 255], got \"2\""},
        {{"3 0 1 2", "-3 0 1 2"}, ":15: the number of corners must be a whole number within [3, 255], got \"-3\""},
        {{"3 0 1 2", "256 0 1 2"}, ":15: the number of corners must be a whole number within [3, 255], got \"256\""},
        {{"3 0 1 2", "4 0 1 2"}, ":15: vertex_indices is missing"},
        {{"3 0 1 2", "3 0 1 2 3"}, ":15: the line must end before \"3\""},
        {{"3 0 1 2", "3 0 1 4"}, ":15: " + index + "\"4\""},
        {{"3 0 1 2", "3 0 1 -1"}, ":15: " + index + "\"-1\""},
        {{"3 0 1 2", "3 0 1 1.5"}, ":15: " + index + "\"1.5\""},
        {{"3 0 1 2", "3 0 1 4294967296"}, ":15: " + index + "\"4294967296\""},
        {{"3 0 1 2", "3 0 1 2/1"}, ":15: " + index + "\"2/1\""},
        {{"3 0 2 3\n", "3 0 2 3\n0 0 0\n"}, ":17: nothing may follow the last element"},
        {{"0 1 1e-40\n", ""}, ":14: the line must end before \"2\""},
        {{"3 0 1 2\n3 0 2 3\n", "3 0 1 2 \n\n\n    \n"}, ":19: the file ends before element \"face\" does"},
        {{"property list", "property list short char a\nproperty list"}, ":16: the number of corners is missing"},
        {{"indices", "indices\nproperty char a"}, ":16: property \"a\" is missing"},
        {{"property list", "property char a\nproperty list"},
         ":16: the number of corners must be a whole number within [3, 255], got \"0\""},
    };
    for (const auto& [change, reason] : cases) {
        EXPECT_EQ(refusal_with(change.first, change.second), reason.empty() ? "" : "a.ply" + reason) << change.second;
    }
}

TEST(MeshPlyRefusals, OfBinaryData) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        const std::string header =
            binary_header(order,
                          "element vertex 1\nproperty float x\nproperty double y\nproperty int z\n"
                          "element face 1\nproperty list short int vertex_index\n");
        const auto refused = [&](float x, double y, int corner_count, std::int64_t index, std::string_view more = "") {
            BinaryData data(order);
            data.add(x).add(y).add<std::int32_t>(5).add(static_cast<std::int16_t>(corner_count));
            data.add_all<std::int32_t>(0, 0, index);
            const std::string message = ply_refusal(header + data.bytes() + std::string(more));
            const std::string start = "a.ply: byte ";
            if (message.empty()) return message;
            EXPECT_EQ(message.substr(0, start.size()), start);
            const std::size_t end = message.find(": ", start.size());
            const int byte = std::stoi(message.substr(start.size())) - static_cast<int>(header.size());
            return std::to_string(byte) + message.substr(end);
        };
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        const std::string finite = "must be a finite number within single precision, got ";
        const std::string vertex = ": \"vertex\" 0: ", face = ": \"face\" 0: ";
        EXPECT_EQ(refused(1, 2, 3, 0), "");
        EXPECT_EQ(refused(std::nanf(""), 2, 3, 0), "4" + vertex + "x " + finite + "nan");
        EXPECT_EQ(refused(-kInfinity, 2, 3, 0), "4" + vertex + "x " + finite + "-inf");
        EXPECT_EQ(refused(1, 3.5e38, 3, 0), "12" + vertex + "y " + finite + "3.5e+38");
        EXPECT_EQ(refused(1, 1e-300, 3, 0), "");
        EXPECT_EQ(refused(1, 2, 2, 0),
                  "18" + face + "the number of corners must be a whole number within [3, 2147483647], got 2");
        EXPECT_EQ(refused(1, 2, -1, 0),
                  "18" + face + "the number of corners must be a whole number within [3, 2147483647], got -1");
        EXPECT_EQ(refused(1, 2, 3, 1), "30" + face + "vertex_index must be a whole number within [0, 0], got 1");
        EXPECT_EQ(refused(1, 2, 3, -1), "30" + face + "vertex_index must be a whole number within [0, 0], got -1");
        EXPECT_EQ(refused(1, 2, 4, 0), "30" + face + "the file ends within \"vertex_index\"");
        EXPECT_EQ(refused(1, 2, 3, 0, "x"), "30: nothing may follow the last element");
    }
}

TEST(MeshPlyRefusals, OfListsThatAreSkipped) {
    const std::string header = binary_header(std::endian::little,
                                             "element a 1\nproperty list int double b\n"
                                             "element vertex 1\nproperty char x\nproperty char y\nproperty char z\n"
                                             "element face 1\nproperty list uchar uchar vertex_index\n");
    const auto refused = [&](std::int32_t count) {
        BinaryData data(std::endian::little);
        data.add(count).add_all<std::uint8_t>(0, 0, 0, 3, 0, 0, 0);
        const std::string message = ply_refusal(header + data.bytes());
        return message.empty() ? message : message.substr(message.find("\"a\""));
    };
    EXPECT_EQ(refused(0), "");
    EXPECT_EQ(refused(-1), "\"a\" 0: b must be a whole number within [0, 9223372036854775807], got -1");
    EXPECT_EQ(refused(1), "\"a\" 0: the file ends within \"b\"");
    EXPECT_EQ(refused(0x7fffffff), "\"a\" 0: the file ends within \"b\"");
}

TEST(MeshPlyRefusals, OfNormalsAndUvThatAreNotFinite) {
    for (const std::string name : {"nz", "v"}) {
        std::string file = with(kAsciiSquare, "float z\n",
                                "float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float u\n"
                                "property float v\n");
        file = with(file, "0 0 0\n1 0 0\n1 1 -2.5e-1\n0 1 1e-40\n",
                    std::string("0 0 0 0 0 1 0 0\n1 0 0 0 0 ") + (name == "nz" ? "nan 0 0" : "1 0 inf") +
                        "\n1 1 0 0 0 1 0 0\n0 1 0 0 0 1 0 0\n");
        EXPECT_EQ(ply_refusal(file), "a.ply:17: " + name + " must be a finite number within single precision, got \"" +
                                         (name == "nz" ? "nan\"" : "inf\""));
    }
}

TEST(MeshPlyRefusals, OfNormalsOfNoLength) {
    const std::string properties = "property float nx\nproperty float ny\nproperty float nz\n";
    const std::string text = with(kAsciiSquare, "float z\n", "float z\n" + properties);
    EXPECT_EQ(ply_refusal(with(text, "0 0 0\n1 0 0\n1 1 -2.5e-1\n0 1 1e-40\n",
                               "0 0 0 0 0 1\n1 0 0 0 -0 0\n1 1 0 0 0 1\n0 1 0 0 0 1\n")),
              "a.ply:15: nx, ny and nz must not all be 0");
    BinaryData data(std::endian::big);
    data.add_all<float>(0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0);
    data.add<std::uint8_t>(3).add_all<std::int32_t>(0, 1, 2);
    const std::string header =
        binary_header(std::endian::big, "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
                                            properties + "element face 1\nproperty list uchar int vertex_indices\n");
    EXPECT_EQ(ply_refusal(header + data.bytes()),
              fmt::format("a.ply: byte {}: \"vertex\" 1: nx, ny and nz must not all be 0", header.size() + 48));
}

TEST(MeshPlyRefusals, OfEveryTruncation) {
    for (const std::string& file : {kAsciiSquare, binary_triangle(), binary_triangle(std::endian::big)}) {
        const std::size_t whole = file.size() - (file == kAsciiSquare ? 1 : 0);  // the last line may lack its end
        for (std::size_t size = 0; size < whole; ++size) EXPECT_NE(ply_refusal(file.substr(0, size)), "") << size;
        EXPECT_EQ(ply_refusal(file), "");
    }
}

TEST(MeshPlyRefusals, DamagedFilesAreReadOrRefused) {
    std::mt19937 random(1);
    int refused_count = 0;
    constexpr int kRounds = 4000;
    for (int round = 0; round < kRounds; ++round) {
        std::string file = round % 2 == 0 ? kAsciiSquare : binary_triangle();
        for (unsigned flips = 1 + random() % 3; flips > 0; --flips) {
            file[random() % file.size()] ^= static_cast<char>(1U << (random() % 8));
        }
        refused_count += ply_refusal(file).empty() ? 0 : 1;  // anything but an InputError fails the test
    }
    EXPECT_GT(refused_count, kRounds / 4);
    EXPECT_LT(refused_count, kRounds);
}

}  // namespace
}  // namespace raypool
