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
#include <ostream>
#include <set>

#include <nlohmann/json.hpp>

#include "core/film/checkpoint.h"
#include "tests/equivalence/same_image.h"
#include "wavefront/engine.h"

namespace raypool {
namespace {

const std::filesystem::path kFolder = RAYPOOL_SOURCE_DIR "/tests/equivalence";

nlohmann::json read_hashes() {
    std::ifstream file(kFolder / "golden_hashes.json");
    return file ? nlohmann::json::parse(file) : nlohmann::json::object();
}

std::filesystem::path picture_of(const std::string& name) {
    return kFolder / "golden" / (name + ".exr");
}

struct GoldenCase {
    std::string name;
    std::string scene;
    LightSampling light_sampling = LightSampling::None;
    Sampler sampler = Sampler::Independent;
    bool roulette = false;
    int split_depth = 0;
};

/// For the test's name.
void PrintTo(const GoldenCase& golden, std::ostream* out) {
    *out << golden.name;
}

std::vector<GoldenCase> all_cases() {
    static const std::set<std::string> kForLightSampling{"caustic",    "instances", "many_lights", "sky_image",
                                                         "small_lamp", "smooth",    "solids"};
    std::vector<std::string> scenes = builtin_scene_names();
    scenes.insert(scenes.end(), {"instances", "sky_image", "smooth", "solids", "textures"});
    std::vector<GoldenCase> cases;
    for (const std::string& scene : scenes)
        cases.push_back({scene, scene, kForLightSampling.contains(scene) ? LightSampling::Mis : LightSampling::None});
    cases.push_back({"cornell_by_sobol_and_roulette", "cornell", LightSampling::Mis, Sampler::Sobol, true});
    cases.push_back({"glass_stack_split", "glass_stack", LightSampling::None, Sampler::Independent, false, 2});
    cases.push_back({"smooth_split_by_sobol", "smooth", LightSampling::Light, Sampler::Sobol, false, 2});
    return cases;
}

/// Small, and yet enough paths for every material and texture of the scene to be met.
template <class Scalar>
Rendered golden_render(const GoldenCase& golden, const Engine& engine) {
    const CompiledScene<Scalar> scene = compile<Scalar>(small_scene(golden.scene, 40));
    RenderSettings settings;
    settings.end_sample = 8;
    settings.depth = 50;
    settings.light_sampling = golden.light_sampling;
    settings.sampler = golden.sampler;
    settings.roulette = golden.roulette;
    settings.split_depth = golden.split_depth;
    return render(engine, scene, settings);
}

wavefront::WavefrontEngine pool(wavefront::StageWidth width) {
    wavefront::PoolSettings settings;
    settings.width = width;
    if (width == wavefront::StageWidth::Scalar) settings.intersection = wavefront::Intersection::Single;
    return wavefront::WavefrontEngine(settings);
}

void update(const std::string& name, const Rendered& in_float, const Rendered& in_double) {
    nlohmann::json hashes = read_hashes();
    nlohmann::json made = {{"float", in_float.hash()}, {"double", in_double.hash()}, {"image_version", kImageVersion}};
    const nlohmann::json committed = hashes.value(name, nlohmann::json::object());
    if (committed.value("float", "") == made["float"] && committed.value("double", "") == made["double"]) return;
    ASSERT_LT(committed.value("image_version", 0), kImageVersion)
        << "checkpoints of before and of after must differ: raise kImageVersion (core/film/checkpoint.h)";
    hashes[name] = std::move(made);
    std::ofstream(kFolder / "golden_hashes.json") << hashes.dump(2) << "\n";
    std::filesystem::create_directories(kFolder / "golden");
    write_image(picture_of(name), in_float.image(), {});
}

class Golden : public testing::TestWithParam<GoldenCase> {};

TEST_P(Golden, ImageIsTheCommittedOne) {
    const GoldenCase& golden = GetParam();
    const recursive::RecursiveEngine recursive;
    if (std::getenv("RAYPOOL_UPDATE_GOLDEN") != nullptr)
        return update(golden.name, golden_render<float>(golden, recursive), golden_render<double>(golden, recursive));

    const nlohmann::json hashes = read_hashes();
    ASSERT_TRUE(hashes.contains(golden.name)) << "no hash of " << golden.name << " is committed";
    const Image picture = read_image(picture_of(golden.name));
    const auto check = [&](const char* precision, const char* engine, const Rendered& got) {
        EXPECT_EQ(got.hash(), hashes[golden.name][precision].get<std::string>())
            << golden.name << " in " << precision << " by " << engine << ", beside the committed picture in float: "
            << leave_difference(fmt::format("golden_{}_{}", golden.name, precision), picture, got.image());
    };
    const auto check_engine = [&](const char* name, const Engine& engine) {
        check("float", name, golden_render<float>(golden, engine));
        check("double", name, golden_render<double>(golden, engine));
    };
    check_engine("recursion", recursive);
    check_engine("the pool", pool(wavefront::StageWidth::Simd));
    check_engine("the scalar pool", pool(wavefront::StageWidth::Scalar));
}
INSTANTIATE_TEST_SUITE_P(Scenes, Golden, testing::ValuesIn(all_cases()),
                         [](const auto& test) { return test.param.name; });

TEST(GoldenHashes, AreOfScenesThatExist) {
    std::set<std::string> names;
    for (const GoldenCase& golden : all_cases()) names.insert(golden.name);
    const nlohmann::json committed = read_hashes();
    for (const auto& [name, hashes] : committed.items()) {
        EXPECT_TRUE(names.contains(name)) << name;
        EXPECT_LE(hashes.at("image_version").get<int>(), kImageVersion) << name;
    }
}

}  // namespace
}  // namespace raypool
