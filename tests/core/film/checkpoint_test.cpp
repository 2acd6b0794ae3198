/// A render on disk comes back bit by bit, and nothing else passes for one.
#include "core/film/checkpoint.h"

#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "core/base/error.h"
#include "tests/random_inputs.h"
#include "tests/scratch_folder.h"

namespace raypool::test {
namespace {

Checkpoint some_checkpoint(Halves halves, std::int64_t width = 3, std::int64_t height = 1) {
    Checkpoint sums{{{"scene", "0123"}, {"seed", "7"}},
                    40,
                    {{0, 5}, {7, 40}},
                    {},
                    0,
                    Framebuffer(width, height, FixedPoint::make(40, 2.5), halves)};
    RandomInputs random(1);
    for (std::int64_t& sum : sums.framebuffer.sums()) sum = static_cast<std::int64_t>(random.bits() >> 2U);
    if (halves == Halves::Apart) {
        sums.ranges.clear();
        sums.sample_counts.assign(static_cast<std::size_t>(width * height), 17);
        sums.rounds = 3;
    }
    return sums;
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}
void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

class CheckpointFile : public testing::Test {
  protected:
    ScratchFolder folder_;
    std::filesystem::path path_ = folder_.path() / "a.sums";
};

TEST_F(CheckpointFile, ComesBackBitByBit) {
    for (const Halves halves : {Halves::Together, Halves::Apart}) {
        const Checkpoint sums = some_checkpoint(halves, 5, 4);
        write_checkpoint(path_, sums);
        const Checkpoint back = read_checkpoint(path_);
        EXPECT_EQ(back.key, sums.key);
        EXPECT_EQ(back.spp, sums.spp);
        EXPECT_EQ(back.ranges, sums.ranges);
        EXPECT_EQ(back.sample_counts, sums.sample_counts);
        EXPECT_EQ(back.rounds, sums.rounds);
        EXPECT_EQ(back.framebuffer.hash(), sums.framebuffer.hash());
        EXPECT_EQ(back.framebuffer.fixed_point().limit, sums.framebuffer.fixed_point().limit);
        EXPECT_EQ(back.framebuffer.has_halves(), halves == Halves::Apart);
    }
}

TEST_F(CheckpointFile, CutAtAnyLengthIsRefusedByItsName) {
    write_checkpoint(path_, some_checkpoint(Halves::Apart));
    const std::string whole = bytes_of(path_);
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write_bytes(path_, std::string_view(whole).substr(0, length));
        try {
            static_cast<void>(read_checkpoint(path_));
            FAIL() << length << " of " << whole.size() << " bytes were taken for a whole";
        } catch (const InputError& error) {
            ASSERT_NE(std::string(error.what()).find("a.sums"), std::string::npos) << error.what();
        }
    }
    write_bytes(path_, whole + "0");
    EXPECT_THROW(static_cast<void>(read_checkpoint(path_)), InputError);
}

TEST_F(CheckpointFile, WithAnyBitFlippedIsRefused) {
    write_checkpoint(path_, some_checkpoint(Halves::Together));
    const std::string whole = bytes_of(path_);
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        write_bytes(path_, damaged);
        ASSERT_THROW(static_cast<void>(read_checkpoint(path_)), InputError) << "bit " << bit;
    }
}

TEST_F(CheckpointFile, OfAnotherVersionIsRefusedByItsVersion) {
    for (const char* other : {"1", "4"}) {
        write_checkpoint(path_, some_checkpoint(Halves::Together));
        std::string text = bytes_of(path_);
        const std::size_t at = text.find("\"version\":3");
        ASSERT_NE(at, std::string::npos);
        text.replace(at + 10, 1, other);
        write_bytes(path_, text);
        try {
            static_cast<void>(read_checkpoint(path_));
            FAIL() << "version " << other;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(std::string("of version ") + other), std::string::npos)
                << error.what();
        }
    }
}

/// What a file that begins so, with a right checksum, is refused with; empty if it is not.
std::string refusal_of(std::string text) {
    text += fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
    try {
        static_cast<void>(decode_checkpoint(text, "a.sums"));
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

/// A file without its checksum, one pixel large, with `instead` in place of `part`.
std::string changed(const std::string& part, const std::string& instead) {
    const std::string header =
        R"({"fraction_bits":40,"format":"raypool sums","has_counts":false,"has_halves":false,"height":1,"key":[["seed","40"]],)"
        R"("limit_bits":2,"ranges":[[0,5],[7,40]],"rounds":0,"spp":40,"version":3,"width":1})";
    const std::size_t at = header.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return std::string(header).replace(at, part.size(), instead) + "\n" + std::string(24, '\0');
}

TEST(HostileCheckpoint, AreRefusedWhereverTheirHeaderIsNotAsItIsWritten) {
    EXPECT_EQ(refusal_of(changed("40", "40")), "");
    for (const auto& [part, instead] : std::initializer_list<std::pair<const char*, const char*>>{
             {"\"width\":1", "\"width\":2"},
             {"\"width\":1", "\"width\":1.0"},
             {"\"width\":1", "\"width\":true"},
             {"\"width\":1", "\"width\":18446744073709551615"},
             {"\"height\":1", "\"height\":4294967297"},
             {"\"rounds\":0", "\"rounds\":1e300"},
             {"\"rounds\":0", "\"rounds\":-1"},
             {"\"version\":3", "\"version\":\"1\""},
             {"[0,5],[7,40]", "[0,5],[5,40]"},
             {"[0,5],[7,40]", "[7,40],[0,5]"},
             {"[0,5],[7,40]", "[0,5],[7]"},
             {"[0,5],[7,40]", "[-1,5]"},
             {"[0,5],[7,40]", "[5,5]"},
             {"[[\"seed\",\"40\"]]", "[[\"seed\",40]]"},
             {"[[\"seed\",\"40\"]]", "[[\"\\u001b[2J\",\"40\"]]"},
             {"\"rounds\":0", "\"rounds\":0,\"rounds\":0"}}) {
        const std::string refusal = refusal_of(changed(part, instead));
        EXPECT_EQ(refusal.find("a.sums: "), 0U) << instead;
        EXPECT_EQ(refusal.find('\x1b'), std::string::npos) << instead;
    }
}

TEST(HostileCheckpoint, NestedWithoutEndAreRefusedWithoutDescending) {
    const std::string deep = std::string(300'000, '[') + std::string(300'000, ']');
    EXPECT_NE(refusal_of(changed("\"version\":3", "\"version\":" + deep)), "");
    EXPECT_NE(refusal_of(changed("\"raypool sums\"", deep)), "");
}

TEST_F(CheckpointFile, WithoutABeginningIsRefusedBeforeItIsReadWhole) {
    write_bytes(path_, "");
    std::filesystem::resize_file(path_, std::uintmax_t{1} << 40U);  // holds nothing; reading it would take all memory
    EXPECT_THROW(static_cast<void>(read_checkpoint(path_)), InputError);
}

TEST(SampleRanges, JoinWhereTheyTouchAndAreRefusedWhereTheyOverlap) {
    std::vector<SampleRange> ranges;
    for (const SampleRange& range : {SampleRange{10, 20}, {30, 40}, {0, 5}, {20, 30}})
        ranges = with_range(ranges, range);
    EXPECT_EQ(ranges, (std::vector<SampleRange>{{0, 5}, {10, 40}}));
    EXPECT_EQ(gaps(ranges, 50), (std::vector<SampleRange>{{5, 10}, {40, 50}}));
    EXPECT_TRUE(gaps({{0, 50}}, 50).empty());
    EXPECT_EQ(gaps({}, 3), (std::vector<SampleRange>{{0, 3}}));
    for (const SampleRange& range : {SampleRange{4, 6}, {39, 41}, {0, 50}, {15, 16}})
        EXPECT_THROW(static_cast<void>(with_range(ranges, range)), InputError);
}

TEST(ImageKeys, NameTheFirstThingInWhichTheyDiffer) {
    EXPECT_EQ(difference({{"spp", "4"}, {"seed", "0"}}, {{"spp", "4"}, {"seed", "0"}}), "");
    EXPECT_EQ(difference({{"spp", "4"}, {"seed", "0"}}, {{"spp", "4"}, {"seed", "1"}}), "seed 0, not 1");
    EXPECT_EQ(difference({{"spp", "4"}}, {{"image_version", "2"}, {"spp", "4"}}), "no image_version");
    EXPECT_NE(difference({{"spp", "4"}, {"seed", "1"}}, {{"spp", "4"}}), "");
}

}  // namespace
}  // namespace raypool::test
