/// Meshes by the names of their files.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/core/scene/mesh_samples.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

using namespace mesh_samples;

TEST(MeshFile, TheExtensionTellsTheFormat) {
    const ScratchFolder folder;
    for (const char* name : {"a.ply", "a.PLY"}) {
        set_file_text(folder / name, kAsciiSquare);
        expect_same(read_mesh(folder / name), square());
    }
    for (const char* name : {"a.obj", "a.Obj"}) {
        set_file_text(folder / name, "v 0 0 0\nv 1 0 0\nv 1 1 -.25\nv 0 1 1e-40\nf 1 2 3 4\n");
        expect_same(read_mesh(folder / name), square());
    }
    for (const char* name : {"a.stl", "a", ".ply", "ply"}) {
        set_file_text(folder / name, kAsciiSquare);
        EXPECT_EQ(refusal([&] { read_mesh(folder / name); }),
                  (folder / name).string() + ": a mesh file's name must end in .ply or .obj");
    }
}

TEST(MeshFile, ARefusalNamesTheFile) {
    const ScratchFolder folder;
    const auto refused = [&](const char* name) {
        const std::string message = refusal([&] { read_mesh(folder / name); });
        const std::string path = (folder / name).string();
        EXPECT_EQ(message.substr(0, path.size()), path);
        return message.substr(path.size());
    };
    EXPECT_EQ(refused("absent.ply"), ": cannot be read: No such file or directory");
    std::filesystem::create_directory(folder / "folder.ply");
    EXPECT_EQ(refused("folder.ply"), ": cannot be read: Is a directory");
    set_file_text(folder / "empty.ply", "");
    EXPECT_EQ(refused("empty.ply"), ": not a PLY file: must begin with the line \"ply\"");
    set_file_text(folder / "b.ply", with(kAsciiSquare, "1 0 0\n", "1 nan 0\n"));
    EXPECT_EQ(refused("b.ply"), ":12: y must be a finite number within single precision, got \"nan\"");
    set_file_text(folder / "b.obj", "\nf 1 2 3\n");
    EXPECT_EQ(refused("b.obj"), ":2: v 1 is not among the 0 before this line");
}

TEST(MeshFile, AFileTooLargeForTheMemoryIsRefusedUnread) {
    const ScratchFolder folder;
    set_file_text(folder / "large.ply", kAsciiSquare);
    std::filesystem::resize_file(folder / "large.ply", std::uintmax_t{1} << 43);  // a hole
    const std::string message = refusal([&] { read_mesh(folder / "large.ply"); });
    EXPECT_NE(message.find("large.ply: the file and its mesh take 17592.2 GB, of "), std::string::npos) << message;
}

}  // namespace
}  // namespace raypool
