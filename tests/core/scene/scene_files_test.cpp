/// Where scenes and their textures lie: in files, among the built-in scenes, beside each other, within limits.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/scene/scene_hash.h"
#include "core/scene/scene_reader.h"
#include "tests/core/image/image_samples.h"
#include "tests/core/scene/scene_text.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using namespace scene_text;

/// An empty folder of this test process alone, removed with what is in it.
class SceneFolder : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("raypool_scene_reader_" + std::to_string(getpid()));
        fs::create_directories(folder_ / "scene");
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }

    std::string refusal_of_texture(const std::string& file) const {
        const std::string texture = R"("textures": {"t": {"type": "image", "file": ")" + file + R"("}}, "shapes")";
        return refusal([&] { parse_scene(with(kSmallest, "\"shapes\"", texture), "a.json", folder_ / "scene"); });
    }

    std::string refusal_of_environment(const std::string& file, const std::string& keys = "") const {
        const std::string image = R"({"image": ")" + file + "\"" + keys + "}";
        return refusal([&] { parse_scene(with(kSmallest, "[0.25, 0.5, 1]", image), "a.json", folder_ / "scene"); });
    }

    fs::path folder_;
};

TEST(SceneReader, EveryCommittedSceneParsesUnderItsFileName) {
    int count = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kScenes)) {
        const std::string file = entry.path().filename().string();
        if (!file.ends_with(".json") || file.ends_with(".schema.json")) continue;
        const Scene scene = read_scene(entry.path());
        EXPECT_EQ(scene.name, entry.path().stem().string());
        EXPECT_FALSE(scene.spheres.empty() && scene.meshes.empty()) << file;
        ++count;
    }
    EXPECT_GE(count, 8);
}

TEST(SceneReader, PaperIsTheSceneOfThePaper) {
    const Scene scene = builtin_scene("paper");
    EXPECT_EQ(scene.width, 400);
    EXPECT_EQ(scene.height, 225);
    EXPECT_NEAR(static_cast<double>(scene.spheres.size()), 484, 4);
    int moving_count = 0;
    for (const Sphere& sphere : scene.spheres) {
        const Vector3d motion = sphere.center1 - sphere.center0;
        const bool is_diffuse = scene.materials.at(sphere.material_id).kind == Material::Kind::Diffuse;
        EXPECT_EQ(motion.norm() > 0, is_diffuse && sphere.radius == 0.2);
        EXPECT_TRUE(motion.x() == 0 && motion.z() == 0 && motion.y() >= 0 && motion.y() <= 0.5);
        moving_count += motion.norm() > 0;
    }
    EXPECT_NEAR(moving_count, 0.8 * 480, 4 * 8.8);  // four standard deviations of a binomial count
}

TEST(SceneReader, BuiltinScenesAreTheFilesOfTheSourceTree) {
    std::vector<std::string> expected;
    for (const fs::directory_entry& entry : fs::directory_iterator(kScenes)) {
        const std::string file = entry.path().filename().string();
        if (file.ends_with(".json") && !file.ends_with(".schema.json"))
            expected.push_back(entry.path().stem().string());
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(builtin_scene_names(), expected);
    for (const char* name : {"caustic", "cornell", "furnace", "glass_stack", "half_sky", "many_lights",
                             "mirror_corridor", "one_sphere", "paper", "small_lamp"}) {
        EXPECT_TRUE(std::count(expected.begin(), expected.end(), name)) << name;
    }

    for (const std::string& name : expected) {
        const Scene built_in = builtin_scene(name);
        const Scene from_file = read_scene(kScenes / (name + ".json"));
        EXPECT_EQ(built_in.name, name);
        EXPECT_EQ(built_in.description, from_file.description);
        EXPECT_EQ(built_in.spheres.size(), from_file.spheres.size());
        for (const Texture& texture : built_in.textures) EXPECT_NE(texture.kind, Texture::Kind::Image) << name;
    }
}

TEST(SceneReader, AnUnknownNameListsTheBuiltinScenes) {
    EXPECT_EQ(refusal([] { load_scene("no_such"); }),
              "no_such: no such file, and no built-in scene of that name (there are caustic, cornell, furnace, "
              "glass_stack, half_sky, many_lights, mirror_corridor, one_sphere, paper, small_lamp)");
    EXPECT_NE(refusal([] { load_scene(""); }), "");
    EXPECT_NE(refusal([] { load_scene(std::string(100'000, 'x')); }), "");
    EXPECT_EQ(load_scene("furnace").name, "furnace");
}

TEST_F(SceneFolder, AFileWinsOverABuiltinSceneAndABuiltinSceneOverAFolder) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    write("furnace", kSmallest);
    fs::create_directory("paper");
    const Scene file = load_scene("furnace");
    const Scene builtin = load_scene("paper");
    fs::current_path(before);
    EXPECT_EQ(file.description, "nothing");
    EXPECT_EQ(builtin.name, "paper");
}

TEST_F(SceneFolder, AFileThatCannotBeReadIsRefusedWithItsCause) {
    const std::string absent = (folder_ / "absent.json").string();
    EXPECT_EQ(refusal([&] { read_scene(absent); }), absent + ": cannot be read: No such file or directory");
    EXPECT_EQ(refusal([&] { read_scene(folder_); }), folder_.string() + ": cannot be read: Is a directory");
    EXPECT_EQ(refusal([&] { load_scene(folder_.string()); }), folder_.string() + ": cannot be read: Is a directory");
    if (geteuid() == 0) GTEST_SKIP() << "the superuser may read every file";
    const fs::path locked = write("locked.json", kSmallest);
    fs::permissions(locked, fs::perms::none);
    EXPECT_EQ(refusal([&] { read_scene(locked); }), locked.string() + ": cannot be read: Permission denied");
}

TEST(SceneReader, AnEndlessFileIsRefusedAtTheLimit) {
    EXPECT_EQ(refusal([] { read_scene("/dev/zero"); }), "/dev/zero: must not be longer than 268435456 bytes");
}

TEST_F(SceneFolder, TexturesAreFoundBesideTheSceneFile) {
    fs::copy_file(kScenes / "textures/map.png", folder_ / "scene/map.png");
    write("scene/a.json", file_text(kScenes / "textures/textures.json"));
    EXPECT_EQ(read_scene(folder_ / "scene/a.json").name, "a");

    const fs::path before = fs::current_path();
    fs::current_path(folder_ / "scene");
    EXPECT_EQ(refusal([] { read_scene("a.json"); }), "");
    fs::current_path(before);
}

TEST_F(SceneFolder, ATextureStaysBelowTheScenesFolderWhereverLinksLead) {
    fs::copy_file(kScenes / "textures/map.png", folder_ / "outside.png");
    fs::copy_file(kScenes / "textures/map.png", folder_ / "scene/map.png");
    fs::create_symlink("map.png", folder_ / "scene/inward.png");
    fs::create_symlink("../outside.png", folder_ / "scene/outward.png");
    fs::create_directory_symlink("..", folder_ / "scene/up");
    fs::create_symlink("loop.png", folder_ / "scene/loop.png");
    fs::create_directory_symlink("scene", folder_ / "scene_by_link");

    EXPECT_EQ(refusal_of_texture("map.png"), "");
    EXPECT_EQ(refusal_of_texture("./map.png"), "");
    EXPECT_EQ(refusal_of_texture("inward.png"), "");
    const std::string outside = fs::canonical(folder_ / "outside.png").string();
    const std::string refused =
        "a.json: /textures/t/file: must stay below the scene's folder, got a link to " + outside;
    EXPECT_EQ(refusal_of_texture("outward.png"), refused);
    EXPECT_EQ(refusal_of_texture("up/outside.png"), refused);
    EXPECT_NE(refusal_of_texture("loop.png"), "");

    write("scene/a.json",
          with(kSmallest, "\"shapes\"", R"("textures": {"t": {"type": "image", "file": "map.png"}}, "shapes")"));
    EXPECT_EQ(refusal([&] { read_scene(folder_ / "scene_by_link/a.json"); }), "");
}

TEST_F(SceneFolder, TexturesTogetherHoldNoMoreThanTheirLimit) {
    fs::copy_file(kScenes / "textures/map.png", folder_ / "scene/map.png");
    // As large as all images together may be, and so one too many after the other: refused before it is decoded.
    constexpr std::size_t kSide = kMaxTextureSide;
    const std::vector<std::vector<png_byte>> rows(kSide, std::vector<png_byte>(kSide / 8));
    write("scene/whole.png", png_of(kSide, kSide, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, 0, rows));
    write("scene/a.json", with(kSmallest, "\"shapes\"", R"("textures": {"a": {"type": "image", "file": "map.png"},
        "b": {"type": "image", "file": "whole.png"}}, "shapes")"));
    const std::string message = refusal([&] { read_scene(folder_ / "scene/a.json"); });
    EXPECT_NE(message.find("/textures/b/file: must name a PNG image that can be read"), std::string::npos) << message;
    EXPECT_NE(message.find("got 16384 x 16384"), std::string::npos) << message;
}

TEST_F(SceneFolder, AnImageAroundTheSceneIsReadOrRefusedNamingSceneAndImage) {
    Image image(4, 2);
    const auto refused = [&](const std::string& name, const std::string& keys = "") {
        write_image(folder_ / "scene" / name, image, {});
        return refusal_of_environment(name, keys);
    };
    for (const char* name : {"sky.exr", "sky.pfm", "sky.EXR"}) EXPECT_EQ(refused(name), "") << name;
    image.rgb[5] = 1e6F;
    EXPECT_EQ(refused("bright.pfm", R"(, "scale": 1.0, "rotation_degrees": -360)"), "");
    EXPECT_EQ(refused("bright.pfm", R"(, "scale": 2)"),
              "a.json: /background/scale: must leave the radiance within [0, 1e+06], got one that reaches 2e+06");
    image.rgb[5] = 1e30F;
    EXPECT_EQ(refused("bright.exr"),
              "a.json: /background/image: must leave the radiance within [0, 1e+06], got one that reaches 1e+30");

    const std::string rule = "a.json: /background/image: must name an image whose values are finite and not negative";
    for (const auto& [value, says] : {std::pair{-1.0F, "-1"},
                                      {std::numeric_limits<float>::infinity(), "inf"},
                                      {std::numeric_limits<float>::quiet_NaN(), "nan"}}) {
        image.rgb[5] = value;
        for (const std::string name : {"bad.exr", "bad.pfm"})
            EXPECT_EQ(refused(name), fmt::format("{}, got {} with {} in column 1 of row 0", rule, name, says));
    }
    image = Image(4, 3);
    EXPECT_EQ(refused("high.exr"),
              "a.json: /background/image: must name an image twice as wide as high, got high.exr of 4 x 3");
    image = Image(1, 1);
    EXPECT_EQ(refused("one.pfm"),
              "a.json: /background/image: must name an image twice as wide as high, got one.pfm of 1 x 1");

    fs::copy_file(kScenes / "textures/map.png", folder_ / "scene/map.png");
    write("scene/broken.exr", "no image");
    write("scene/empty.pfm", "PF\n0 0\n-1\n");
    write("scene/huge.pfm", "PF\n44721 22361\n-1\n");  // 10^9 pixels
    write("scene/wide.pfm", "PF\n20000 10000\n-1\n");
    for (const std::string name : {"map.png", "absent.exr", "broken.exr", "empty.pfm", "huge.pfm", "wide.pfm", "sky"}) {
        const std::string message = refusal_of_environment(name);
        const std::string beginning = "a.json: /background/image: must name an EXR or PFM image that can be read, got ";
        EXPECT_EQ(message.substr(0, beginning.size()), beginning);
        EXPECT_NE(message.find(name), std::string::npos) << message;
    }
    write_image(folder_ / "outside.exr", Image(2, 1), {});
    fs::create_symlink("../outside.exr", folder_ / "scene/outward.exr");
    EXPECT_EQ(refusal_of_environment("outward.exr"),
              "a.json: /background/image: must stay below the scene's folder, "
              "got a link to " +
                  fs::canonical(folder_ / "outside.exr").string());
    EXPECT_EQ(refusal_of_environment("../outside.exr"),
              "a.json: /background/image: must be a path below the scene's folder, without \"..\", got "
              "\"../outside.exr\"");
}

TEST_F(SceneFolder, AnImageAroundTheSceneIsPartOfItsHash) {
    Image image(4, 2);
    const auto hash = [&](const std::string& keys) {
        write_image(folder_ / "scene/sky.exr", image, {});
        const std::string background = R"({"image": "sky.exr")" + keys + "}";
        return scene_hash(parse_scene(with(kSmallest, "[0.25, 0.5, 1]", background), "a.json", folder_ / "scene"));
    };
    const std::string plain = hash("");
    EXPECT_EQ(hash(R"(, "rotation_degrees": 0, "scale": 1)"), plain);
    EXPECT_NE(hash(R"(, "rotation_degrees": 1)"), plain);
    EXPECT_NE(hash(R"(, "scale": 2)"), plain);
    image.rgb[0] = 1;
    EXPECT_NE(hash(""), plain);
}

TEST_F(SceneFolder, AFileIsReadUpToItsLimitAndNoFurther) {
    constexpr std::size_t kLimit = std::size_t{256} << 20;
    std::string text(kLimit, 'x');  // read whole, it is no JSON: quicker to refuse than a scene so long is to parse
    EXPECT_NE(refusal([&] { read_scene(write("scene/a.json", text)); }).find("a.json:1:1: syntax error"),
              std::string::npos);
    text += ' ';
    EXPECT_NE(refusal([&] { read_scene(write("scene/a.json", text)); }).find("must not be longer than"),
              std::string::npos);
}

TEST_F(SceneFolder, AnAbsentOrBrokenTextureIsRefusedNamingSceneAndImage) {
    write("scene/broken.png", "no image");
    fs::create_directory(folder_ / "scene/folder.png");
    for (const std::string name :
         {"absent.png", "broken.png", "folder.png", "absent/deep.png", "broken.png/deep.png", "."}) {
        const std::string message = refusal_of_texture(name);
        const std::string beginning = "a.json: /textures/t/file: must name a PNG image that can be read, got ";
        EXPECT_EQ(message.substr(0, beginning.size()), beginning);
        EXPECT_NE(message.find(name), std::string::npos) << message;
    }
    EXPECT_NE(refusal_of_texture(std::string(5000, 'x') + ".png"), "");
    EXPECT_NE(refusal_of_texture("map.png\\u0000/../../etc"), "");
}

}  // namespace
}  // namespace raypool
