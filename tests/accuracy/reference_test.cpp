/// The cache of references: made once, in ranges, for one scene and size; and never a damaged or foreign one.
#include "bench/accuracy/reference.h"

#include <fstream>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/scene/scene_hash.h"
#include "tests/scratch_folder.h"
#include "tests/small_render.h"

namespace raypool::accuracy {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSpp = 10;

std::shared_ptr<const SceneInBoth> scene(const std::string& name = "one_sphere") {
    return std::make_shared<const SceneInBoth>(small_scene(name, 16));
}

std::vector<fs::path> files(const fs::path& folder) {
    std::vector<fs::path> found(fs::directory_iterator(folder), {});
    std::sort(found.begin(), found.end());
    return found;
}

TEST(Reference, IsTheTrustedImageOfTwoSeedsHoweverItIsCutIntoRanges) {
    const auto made_of = [&](std::size_t half) {
        return render_image(kTrusted, *scene(), {0, kSpp, kReferenceSeeds[half], 1}).values;
    };
    for (const std::int64_t range : {1, 3, 7, 100}) {
        Reference reference(scene(), kSpp, {}, 1);
        while (reference.extend(range) > 0) {
        }
        EXPECT_EQ(reference.halves().a, made_of(0)) << range;
        EXPECT_EQ(reference.halves().b, made_of(1)) << range;
    }
    EXPECT_NE(made_of(0), made_of(1));
}

TEST(Reference, GoesOnWhereItWasInterrupted) {
    const ScratchFolder folder;
    Reference whole(scene(), kSpp, {}, 2);
    {
        Reference begun(scene(), kSpp, folder / "references", 1);
        EXPECT_EQ(begun.extend(7), 2 * kSpp - 7);
        EXPECT_EQ(begun.extend(7), 2 * kSpp - 14) << "the halves take turns";
    }
    ASSERT_EQ(files(folder / "references").size(), 2);
    Reference resumed(scene(), kSpp, folder / "references", 1);
    EXPECT_EQ(resumed.extend(1), 5);
    EXPECT_EQ(resumed.halves().a, whole.halves().a);
    EXPECT_EQ(resumed.halves().b, whole.halves().b);

    // Now it is complete, and taken as it lies there.
    const auto before = fs::last_write_time(files(folder / "references")[0]);
    Reference found(scene(), kSpp, folder / "references", 1);
    EXPECT_EQ(found.extend(1), 0);
    EXPECT_EQ(found.halves().a, whole.halves().a);
    EXPECT_EQ(fs::last_write_time(files(folder / "references")[0]), before);
}

TEST(Reference, RefusesADamagedFileNamingIt) {
    const ScratchFolder folder;
    Reference(scene(), kSpp, folder / "r", 1).halves();
    const fs::path path = files(folder / "r")[0];
    const auto bytes = [&] {
        std::ifstream stream(path, std::ios::binary);
        return std::string{std::istreambuf_iterator<char>(stream), {}};
    }();
    const auto is_refused = [&](const std::string& content) {
        std::ofstream(path, std::ios::binary) << content;
        try {
            Reference(scene(), kSpp, folder / "r", 1).halves();
        } catch (const InputError& error) {
            return std::string(error.what()).find(path.string()) != std::string::npos;
        }
        return false;
    };
    std::string flipped = bytes;
    flipped[bytes.size() - 100] ^= 1;
    EXPECT_TRUE(is_refused(flipped)) << "a bit of a sum";
    std::string other_count = bytes;
    other_count.replace(other_count.find("\"ranges\":[[0,10]]"), 17, "\"ranges\":[[0,11]]");
    EXPECT_TRUE(is_refused(other_count)) << "the count of samples";
    EXPECT_TRUE(is_refused(bytes.substr(0, bytes.size() - 8))) << "an end cut off";
    EXPECT_TRUE(is_refused("")) << "nothing";
    EXPECT_FALSE(is_refused(bytes));
}

TEST(Reference, HasAnotherKeyForWhateverShapesItsImage) {
    const std::string key = Reference(scene(), kSpp, {}, 1).key();
    EXPECT_EQ(Reference(scene(), kSpp, {}, 2).key(), key);
    EXPECT_NE(Reference(scene("furnace"), kSpp, {}, 1).key(), key);
    EXPECT_NE(Reference(scene(), kSpp + 1, {}, 1).key(), key);
    EXPECT_NE(Reference(std::make_shared<const SceneInBoth>(small_scene("one_sphere", 17)), kSpp, {}, 1).key(), key);
}

TEST(SceneHash, ChangesWithWhatShapesTheImageAndWithNothingElse) {
    const Scene scene = small_scene("paper", 16);
    const std::string hash = scene_hash(scene);
    const auto changed = [&](auto change) {
        Scene other = scene;
        change(other);
        return scene_hash(other) != hash;
    };
    EXPECT_FALSE(changed([](Scene& s) { s.name = "other"; }));
    EXPECT_FALSE(changed([](Scene& s) { s.description = "other"; }));
    EXPECT_TRUE(changed([](Scene& s) { ++s.height; }));
    EXPECT_TRUE(changed([](Scene& s) { s.camera.shutter_close /= 2; }));
    EXPECT_TRUE(changed([](Scene& s) { s.background.top[2] += 1e-9; }));
    EXPECT_TRUE(changed([](Scene& s) { s.spheres.back().center1[1] += 1e-9; }));
    EXPECT_TRUE(changed([](Scene& s) { s.spheres.pop_back(); }));
    EXPECT_TRUE(changed([](Scene& s) { s.materials.back().ior += 1e-9; }));
    EXPECT_TRUE(changed([](Scene& s) { s.textures.front().odd[0] += 1e-9; }));
}

}  // namespace
}  // namespace raypool::accuracy
