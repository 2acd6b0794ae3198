// The committed scenes still make the images that they made when golden_hashes.json was written: on any compiler and
// for any instruction set. Where an image had to change, raise kImageVersion (core/film/checkpoint.h), write the hashes
// and pictures anew, look at the pictures, and say in the change why:
//
//     RAYPOOL_UPDATE_GOLDEN=1 ctest --preset release --tests-regex Golden
//
// The pictures in golden/ are not compared with; they show where an image that fails is different.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

#include "core/film/checkpoint.h"
#include "tests/equivalence/same_image.h"

namespace raypool {
namespace {

const std::filesystem::path kFolder = RAYPOOL_SOURCE_DIR "/tests/equivalence";

nlohmann::json read_hashes() {
    std::ifstream file(kFolder / "golden_hashes.json");
    return file ? nlohmann::json::parse(file) : nlohmann::json::object();
}

std::filesystem::path picture_of(const std::string& scene_name) {
    return kFolder / "golden" / (scene_name + ".exr");
}

/// Small, and yet enough paths for every material and texture of the scene to be met.
template <class Scalar>
Rendered golden_render(const std::string& scene_name) {
    const CompiledScene<Scalar> scene = compile<Scalar>(small_scene(scene_name, 40));
    RenderSettings settings;
    settings.end_sample = 8;
    settings.depth = 50;
    static const std::set<std::string> kForLightSampling{"caustic",    "instances", "many_lights", "sky_image",
                                                         "small_lamp", "smooth",    "solids"};
    settings.light_sampling = kForLightSampling.contains(scene_name) ? LightSampling::Mis : LightSampling::None;
    return render(recursive::RecursiveEngine(), scene, settings);
}

void update(const std::string& scene_name, const Rendered& in_float, const Rendered& in_double) {
    nlohmann::json hashes = read_hashes();
    nlohmann::json made = {{"float", in_float.hash()}, {"double", in_double.hash()}, {"image_version", kImageVersion}};
    const nlohmann::json committed = hashes.value(scene_name, nlohmann::json::object());
    if (committed.value("float", "") == made["float"] && committed.value("double", "") == made["double"]) return;
    ASSERT_LT(committed.value("image_version", 0), kImageVersion)
        << "checkpoints of before and of after must differ: raise kImageVersion (core/film/checkpoint.h)";
    hashes[scene_name] = std::move(made);
    std::ofstream(kFolder / "golden_hashes.json") << hashes.dump(2) << "\n";
    std::filesystem::create_directories(kFolder / "golden");
    write_image(picture_of(scene_name), in_float.image(), {});
}

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, ImageIsTheCommittedOne) {
    const std::string& name = GetParam();
    const Rendered in_float = golden_render<float>(name);
    const Rendered in_double = golden_render<double>(name);
    if (std::getenv("RAYPOOL_UPDATE_GOLDEN") != nullptr) return update(name, in_float, in_double);

    const nlohmann::json hashes = read_hashes();
    ASSERT_TRUE(hashes.contains(name)) << "no hash of " << name << " is committed";
    const Image picture = read_image(picture_of(name));
    for (const auto& [precision, got] : {std::pair{"float", &in_float}, {"double", &in_double}}) {
        EXPECT_EQ(got->hash(), hashes[name][precision].get<std::string>())
            << name << " in " << precision << ", beside the committed picture in float: "
            << leave_difference(fmt::format("golden_{}_{}", name, precision), picture, got->image());
    }
}

std::vector<std::string> all_scenes() {
    std::vector<std::string> names = builtin_scene_names();
    names.insert(names.end(), {"instances", "sky_image", "smooth", "solids", "textures"});
    return names;
}
INSTANTIATE_TEST_SUITE_P(Scenes, Golden, testing::ValuesIn(all_scenes()), [](const auto& test) { return test.param; });

TEST(GoldenHashes, AreOfScenesThatExist) {
    const std::vector<std::string> scenes = all_scenes();
    const nlohmann::json committed = read_hashes();
    for (const auto& [name, hashes] : committed.items()) {
        EXPECT_NE(std::find(scenes.begin(), scenes.end(), name), scenes.end()) << name;
        EXPECT_LE(hashes.at("image_version").get<int>(), kImageVersion) << name;
    }
}

}  // namespace
}  // namespace raypool
