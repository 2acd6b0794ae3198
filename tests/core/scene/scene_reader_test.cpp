/// The scene file: what it may say, and the exact words with which the rest is refused.
#include "core/scene/scene_reader.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/json_parser.h"
#include "core/scene/scene_hash.h"
#include "tests/core/scene/scene_text.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using namespace scene_text;

std::string refusal_of_text(const std::string& text) {
    return refusal([&] { parse_scene(text, "a.json", kScenes / "textures"); });
}

TEST(SceneReader, TheSmallestSceneHasTheDocumentedDefaults) {
    const Scene scene = parse_scene(kSmallest, "folder/smallest.json", ".");
    EXPECT_EQ(scene.name, "smallest");
    EXPECT_EQ(scene.description, "nothing");
    EXPECT_EQ(scene.width, 400);
    EXPECT_EQ(scene.height, 225);
    EXPECT_EQ(scene.camera.up, Vector3d(0, 1, 0));
    EXPECT_EQ(scene.camera.vertical_fov_degrees, 40);
    EXPECT_EQ(scene.camera.defocus_angle_degrees, 0);
    EXPECT_EQ(scene.camera.shutter_open, 0);
    EXPECT_EQ(scene.camera.shutter_close, 0);
    EXPECT_EQ(scene.background.bottom, Vector3d(0.25, 0.5, 1));
    EXPECT_EQ(scene.background.top, Vector3d(0.25, 0.5, 1));
    EXPECT_TRUE(scene.spheres.empty() && scene.quads.empty() && scene.planes.empty());
    EXPECT_TRUE(scene.materials.empty() && scene.textures.empty());
}

TEST(SceneReader, EveryKeyArrivesInTheScene) {
    const json shared = json::parse(file_text(fs::path(RAYPOOL_SOURCE_DIR) / "tests/scenes/refusals.json"));
    const Scene scene = parse_scene(shared["base"].dump(), "base", kScenes / "textures");
    EXPECT_EQ(scene.width, 40);
    EXPECT_EQ(scene.height, 30);
    EXPECT_EQ(scene.camera.look_from, Vector3d(0, 1, 5));
    EXPECT_EQ(scene.camera.look_at, Vector3d(0, 1, 0));
    EXPECT_EQ(scene.camera.defocus_angle_degrees, 1);
    EXPECT_EQ(scene.camera.focus_distance, 5);
    EXPECT_EQ(scene.camera.shutter_close, 1);
    EXPECT_EQ(scene.background.top, Vector3d(0.5, 0.7, 1));

    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_EQ(scene.spheres[0].center0, Vector3d(0, 1, 0));
    EXPECT_EQ(scene.spheres[0].center1, Vector3d(0, 1.5, 0));
    EXPECT_EQ(scene.spheres[0].radius, 1);
    const Material& glass = scene.materials.at(scene.spheres[0].material_id);
    EXPECT_EQ(glass.kind, Material::Kind::Dielectric);
    EXPECT_EQ(glass.ior, 1.5);

    ASSERT_EQ(scene.quads.size(), 1u);
    EXPECT_EQ(scene.quads[0].corner, Vector3d(0, 0, -2));
    EXPECT_EQ(scene.quads[0].edge_u, Vector3d(1, 0, 0));
    EXPECT_EQ(scene.quads[0].edge_v, Vector3d(0, 1, 0));
    const Material& lamp = scene.materials.at(scene.quads[0].material_id);
    EXPECT_EQ(lamp.kind, Material::Kind::Emissive);
    EXPECT_EQ(scene.textures.at(lamp.texture_id).kind, Texture::Kind::Solid);
    EXPECT_EQ(scene.textures.at(lamp.texture_id).even, Vector3d(5, 5, 5));

    ASSERT_EQ(scene.planes.size(), 1u);
    EXPECT_EQ(scene.planes[0].normal, Vector3d(0, 1, 0));
    const Material& floor = scene.materials.at(scene.planes[0].material_id);
    EXPECT_EQ(floor.kind, Material::Kind::Diffuse);
    const Texture& blocks = scene.textures.at(floor.texture_id);
    EXPECT_EQ(blocks.kind, Texture::Kind::Checker3d);
    EXPECT_EQ(blocks.odd, Vector3d(1, 1, 1));
    EXPECT_EQ(blocks.scale, 0.5);
    EXPECT_EQ(blocks.offset, Vector3d(0, 0.25, 0));

    const auto is_metal = [](const Material& material) { return material.kind == Material::Kind::Metal; };
    const auto metal = std::find_if(scene.materials.begin(), scene.materials.end(), is_metal);
    ASSERT_NE(metal, scene.materials.end());
    EXPECT_EQ(metal->fuzz, 0.1);
    EXPECT_EQ(scene.textures.at(metal->texture_id).even, Vector3d(0.9, 0.9, 0.9));

    const auto is_image = [](const Texture& texture) { return texture.kind == Texture::Kind::Image; };
    const auto map = std::find_if(scene.textures.begin(), scene.textures.end(), is_image);
    ASSERT_NE(map, scene.textures.end());
    EXPECT_EQ(map->image->width, 64);
    EXPECT_EQ(map->image->height, 32);
}

TEST(SceneReader, TellsHowAnImageWrapsAndItsHashCoversIt) {
    const auto read = [](const std::string& wrap) {
        const std::string texture =
            R"("textures": {"t": {"type": "image", "file": "map.png")" + wrap + R"(}}, "shapes")";
        return parse_scene(with(kSmallest, "\"shapes\"", texture), "a.json", kScenes / "textures");
    };
    const Scene by_shape = read(""), repeat = read(R"(, "wrap": "repeat")"), clamp = read(R"(, "wrap": "clamp")");
    EXPECT_EQ(by_shape.textures[0].wrap, Texture::Wrap::ByShape);
    EXPECT_EQ(repeat.textures[0].wrap, Texture::Wrap::Repeat);
    EXPECT_EQ(clamp.textures[0].wrap, Texture::Wrap::Clamp);
    EXPECT_NE(scene_hash(by_shape), scene_hash(repeat));
    EXPECT_NE(scene_hash(by_shape), scene_hash(clamp));
    EXPECT_NE(scene_hash(repeat), scene_hash(clamp));
}

TEST(SceneReader, RefusesEachBrokenRuleNamingItsPlaceAndTheValue) {
    const json shared = json::parse(file_text(fs::path(RAYPOOL_SOURCE_DIR) / "tests/scenes/refusals.json"));
    ASSERT_GT(shared["cases"].size(), 100u);
    for (const json& test : shared["cases"]) {
        const std::string text = shared["base"].patch(test["patch"]).dump();
        EXPECT_EQ(refusal_of_text(text), "a.json: " + test["says"].get<std::string>()) << test["patch"];
    }
}

TEST(SceneReader, RefusesWhatIsNotJsonNamingLineAndColumn) {
    const std::pair<std::string, std::string> cases[] = {
        {"", "a.json:1:1: syntax error while parsing value - unexpected end of input"},
        {"{\n  \"a\": }", "a.json:2:8: syntax error while parsing value - unexpected '}'"},
        {"{\"a\": NaN}", "a.json:1:7: syntax error while parsing value - invalid literal"},
        {"{\"a\": Infinity}", "a.json:1:7: syntax error while parsing value - invalid literal"},
        {"{\"a\": 01}", "a.json:1:8: syntax error while parsing object - unexpected number literal"},
        {"{\"a\": 1,}", "a.json:1:9: syntax error while parsing object key - unexpected '}'"},
        {"{'a': 1}", "a.json:1:2: syntax error while parsing object key - invalid literal"},
        {"// why\n{}", "a.json:1:1: syntax error while parsing value - invalid literal"},
        {"{} {}", "a.json:1:4: syntax error while parsing value - unexpected '{'; expected end of input"},
        {"{\n\n\"a", "a.json:3:3: syntax error while parsing object key - invalid string: missing closing quote"},
        {"{\"\xff\": 1}", "a.json:1:3: syntax error while parsing object key - invalid string: ill-formed UTF-8 byte"},
    };
    for (const auto& [text, beginning] : cases) {
        EXPECT_EQ(refusal_of_text(text).substr(0, beginning.size()), beginning) << text;
    }
    EXPECT_NE(refusal_of_text(kSmallest + " x"), "");
    EXPECT_EQ(refusal_of_text(kSmallest + "\n \t\r\n"), "");
}

TEST(SceneReader, RefusesNumbersBeyondDoublePrecision) {
    EXPECT_EQ(refusal_of_text(with(kSmallest, "[0, 0, 1]", "[0, 0, 1e400]")),
              "a.json: /camera/look_from/2: must be a number within double precision, got 1e400");
    EXPECT_EQ(refusal_of_text(with(kSmallest, "[0, 0, 1]", "-1e400")),
              "a.json: /camera/look_from: must be a number within double precision, got -1e400");
    EXPECT_EQ(refusal_of_text("1e400"), "a.json: must be a number within double precision, got 1e400");
    EXPECT_EQ(refusal_of_text(with(kSmallest, "[0, 0, 1]", "[0, 0, 1" + std::string(300, '0') + "]")),
              "a.json: /camera/look_from/2: must be within [-1e+12, 1e+12], got 1e+300");
}

TEST(SceneReader, RefusesKeysThatAppearTwice) {
    EXPECT_EQ(refusal_of_text(with(kSmallest, "\"shapes\"", "\"background\": [1, 1, 1], \"shapes\"")),
              "a.json: /background: must appear once, got it twice");
    EXPECT_EQ(refusal_of_text(R"({"materials": {"a": 1, "b": 2, "a": 3}})"),
              "a.json: /materials/a: must appear once, got it twice");
    EXPECT_EQ(refusal_of_text(R"({"shapes": [0, {"x": 1, "x": 1}]})"),
              "a.json: /shapes/1/x: must appear once, got it twice");
}

TEST(SceneReader, RefusesDeepNestingWithoutDescending) {
    constexpr std::size_t kBomb = 4'000'000;
    std::string objects;
    for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
    std::string place;
    for (std::size_t i = 0; i < kMaxJsonDepth; ++i) place += "/0";
    EXPECT_EQ(refusal_of_text(std::string(kBomb, '[')),
              "a.json: " + place + ": must not nest deeper than 32 levels, got more");
    EXPECT_NE(refusal_of_text(objects).find("must not nest deeper than 32 levels"), std::string::npos);

    const std::string deepest = std::string(kMaxJsonDepth, '[') + std::string(kMaxJsonDepth, ']');
    EXPECT_EQ(refusal_of_text(deepest), "a.json: must be an object, got an array of 1");
}

TEST(SceneReader, AMessageIsOneLineOfPrintableTextWhateverTheFileHolds) {
    const std::string many(5'000'000, 'x');
    const std::string texts[] = {
        with(kSmallest, "\"shapes\"", "\"a\\nb\\u0000\\u001b[31m\": 1, \"shapes\""),
        with(kSmallest, "\"shapes\": []", "\"shapes\": [{\"type\": \"\\n\\n\"}]"),
        "{\"a\n\n",
        "{\"\x1b[31m",
        many,
        "\"" + many + "\"",
        "{\"" + many + "\": 1}",
    };
    for (const std::string& text : texts) {
        const std::string message = refusal_of_text(text);
        EXPECT_NE(message, "");
        EXPECT_LT(message.size(), 1100u);
        EXPECT_TRUE(std::none_of(message.begin(), message.end(), [](char c) { return c >= 0 && c < 0x20; })) << message;
    }
}

TEST(SceneReader, AcceptsTheEdgesOfItsRanges) {
    const std::string shapes = R"("materials": {"m": {"type": "dielectric", "ior": 10},
        "w": {"type": "diffuse", "albedo": [0, 1, 0]}, "e": {"type": "emissive", "radiance": [1e6, 0, 0]}},
        "image": {"width": 65536.0, "height": 1},
        "shapes": [{"type": "sphere", "center": [1e12, -1e12, 0], "radius": 1e-12, "material": "m"},
                   {"type": "sphere", "center": [0, -0.0, 0], "radius": 1e12, "material": "m"}])";
    const Scene scene = parse_scene(with(kSmallest, "\"shapes\": []", shapes), "a.json", ".");
    EXPECT_EQ(scene.width, 65536);
    EXPECT_EQ(scene.spheres.size(), 2u);
    EXPECT_EQ(scene.spheres[0].center1, scene.spheres[0].center0);
}

TEST(SceneReader, ALampHasAStrengthAndSides) {
    const auto lamp = [](const std::string& keys) {
        const std::string materials =
            R"("materials": {"e": {"type": "emissive", "radiance": [1, 2, 3])" + keys + R"(}}, "shapes": [])";
        const Scene scene = parse_scene(with(kSmallest, "\"shapes\": []", materials), "a.json", ".");
        return std::make_pair(scene.materials.at(0), scene_hash(scene));
    };
    const auto [plain, hash] = lamp("");
    EXPECT_EQ(plain.strength, 1);
    EXPECT_FALSE(plain.front_only);
    EXPECT_EQ(lamp(R"(, "strength": 1, "sides": "both")").second, hash);
    EXPECT_EQ(lamp(R"(, "strength": 2.5)").first.strength, 2.5);
    EXPECT_NE(lamp(R"(, "strength": 2.5)").second, hash);
    EXPECT_TRUE(lamp(R"(, "sides": "front")").first.front_only);
    EXPECT_NE(lamp(R"(, "sides": "front")").second, hash);
}

TEST(SceneReader, TheDocumentedExampleParses) {
    const std::string document = file_text(fs::path(RAYPOOL_SOURCE_DIR) / "docs/scene-format.md");
    const std::size_t begin = document.find("```json\n");
    const std::size_t end = document.find("```", begin + 8);
    ASSERT_NE(end, std::string::npos);
    const Scene scene = parse_scene(document.substr(begin + 8, end - begin - 8), "example.json", kScenes / "textures");
    EXPECT_FALSE(scene.spheres.empty());
}

TEST(SceneReader, EveryTruncationOfASceneIsRefused) {
    const std::string paper = file_text(kScenes / "paper.json");
    const std::size_t last_brace = paper.rfind('}');
    for (std::size_t length = 0; length < paper.size(); length += length < 2000 ? 1 : 997) {
        ASSERT_NE(refusal_of_text(paper.substr(0, std::min(length, last_brace))), "") << length;
    }
    EXPECT_NE(refusal_of_text(paper.substr(0, last_brace)), "");
    EXPECT_EQ(refusal_of_text(paper), "");
}

TEST(SceneReader, DamagedScenesParseOrAreRefused) {
    std::mt19937 random(1);
    const std::string scenes[] = {file_text(kScenes / "textures/textures.json"), file_text(kScenes / "cornell.json")};
    int refused_count = 0;
    constexpr int kRounds = 4000;
    for (int round = 0; round < kRounds; ++round) {
        std::string text = scenes[round % 2];
        for (unsigned flips = 1 + random() % 4; flips > 0; --flips) {
            text[random() % text.size()] ^= static_cast<char>(1u << (random() % 8));
        }
        refused_count += !refusal_of_text(text).empty();  // anything but an InputError fails the test
    }
    EXPECT_GT(refused_count, kRounds / 4);
    EXPECT_LT(refused_count, kRounds);  // some damage only changes a digit or a letter of the description
}

}  // namespace
}  // namespace raypool
