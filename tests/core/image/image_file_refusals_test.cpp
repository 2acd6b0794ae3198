/// What image files must not be believed: cut off, damaged, hostile or simply of another kind.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/image/image_file.h"
#include "tests/core/image/image_samples.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

TEST(ImageFile, RefusesWhatIsNotAReadableFile) {
    const ScratchFolder folder;
    fs::create_directory(folder / "folder.png");
    set_file_text(folder / "empty.png", "");
    set_file_text(folder / "empty.exr", "");
    set_file_text(folder / "empty.pfm", "");
    set_file_text(folder / "text.png", "this is not a picture");
    set_file_text(folder / "text.exr", "this is not a picture");
    set_file_text(folder / "other.pfm", std::string("P6\n1 1\n-1.0\n\0\0\0\0", 16));
    EXPECT_EQ(refusal(folder / "absent.png"), "No such file or directory");
    EXPECT_EQ(refusal(folder / "folder.png"), "Is a directory");
    EXPECT_EQ(refusal(folder / "text.png"), "not a PNG file");
    EXPECT_EQ(refusal(folder / "text.exr"), "not an EXR file");
    EXPECT_EQ(refusal(folder / "other.pfm"), "not a PFM file: must begin with PF or Pf");
    for (const char* name : {"empty.png", "empty.exr", "empty.pfm"}) EXPECT_NE(refusal(folder / name), "") << name;
}

TEST(ImageFile, RefusesAFileCutOffAnywhere) {
    const ScratchFolder folder;
    for (const char* name : {"a.png", "a.exr", "a.pfm"}) {
        write_image(folder / name, wild_image(5, 20), kAttributes);
        const std::string bytes = file_text(folder / name);
        ASSERT_EQ(refusal(folder / name), "");
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            set_file_text(folder / name, std::string_view(bytes).substr(0, size));
            ASSERT_NE(refusal(folder / name), "") << name << " cut off after " << size << " of " << bytes.size();
        }
    }
}

TEST(ImageFile, AnyDamagedByteIsReadOrRefusedButNeverCrashes) {
    const ScratchFolder folder;
    for (const char* name : {"a.png", "a.exr", "a.pfm"}) {
        write_image(folder / name, wild_image(3, 18), {{"raypool.hash", "0"}});
        const std::string bytes = file_text(folder / name);
        int refused_count = 0;
        for (std::size_t place = 0; place < bytes.size(); ++place) {
            for (const int damage : {0x01, 0x80, 0xff}) {
                std::string damaged = bytes;
                damaged[place] = static_cast<char>(damaged[place] ^ damage);
                set_file_text(folder / name, damaged);
                refused_count += !refusal(folder / name).empty();
            }
        }
        EXPECT_GT(refused_count, 10) << name;
    }
}

/// Reads in a process of its own; the most memory it took beyond what it began with, in MiB.
long memory_to_refuse(const fs::path& path) {
    const auto peak = [] {
        rusage usage{};
        ::getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss / 1024;
    };
    std::array<int, 2> channel{};
    if (::pipe(channel.data()) != 0) return -1;
    const pid_t child = ::fork();
    if (child == 0) {
        const long before = peak();
        const bool is_refused = !refusal(path).empty();
        const long taken = is_refused ? peak() - before : -1;
        ::_exit(::write(channel[1], &taken, sizeof taken) == sizeof taken ? 0 : 1);
    }
    ::close(channel[1]);
    long taken = -1;
    const bool is_answered = ::read(channel[0], &taken, sizeof taken) == sizeof taken;
    ::close(channel[0]);
    ::waitpid(child, nullptr, 0);
    return is_answered ? taken : -1;
}

TEST(ImageFile, ClaimedDimensionsAreRefusedBeforeMemoryIsSpentOnThem) {
    const ScratchFolder folder;
    std::vector<fs::path> hostile;
    const auto add = [&](const std::string& name, const std::string& bytes) {
        hostile.push_back(folder / name);
        set_file_text(hostile.back(), bytes);
    };
    for (const char* size : {"65536 16384", "65537 1", "1000000000 1000000000", "4294967296 4294967296", "-1 -1", "0 1",
                             "99999999999999999999 1", "1e3 1", "4294967297 1"}) {
        add(fmt::format("{}.pfm", hostile.size()), fmt::format("PF\n{}\n-1.0\n{}", size, std::string(12, '\0')));
    }
    const std::array<std::array<png_uint_32, 2>, 4> sizes{
        {{65536, 16384}, {65537, 1}, {PNG_UINT_31_MAX, PNG_UINT_31_MAX}, {32768, 32768}}};
    const std::string no_pixels("\0\0\0\0IDAT\x35\xaf\x06\x1e", 12);
    const std::string png_end("\0\0\0\0IEND\xae\x42\x60\x82", 12);
    for (const auto& [width, height] : sizes) {
        std::string header = png_of(width, height, 16, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, 0, {});
        add(fmt::format("{}.png", hostile.size()), header.append(no_pixels).append(png_end));
    }
    const std::string small_header = png_of(1, 1, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, 0, {});
    add("long.png", small_header + std::string("\x70\0\0\0tEXtkey\0text", 16).append(png_end));
    write_image(folder / "good.exr", wild_image(3, 3), {});
    const std::string exr = file_text(folder / "good.exr");
    const std::size_t window = exr.find("dataWindow") + sizeof "dataWindow" + sizeof "box2i" + 4;
    constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
    constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
    const std::array<std::array<std::int32_t, 4>, 6> windows{{{0, 0, 65535, 16383},
                                                              {0, 0, 65536, 0},
                                                              {0, 0, 16383, 65535},
                                                              {kMin, kMin, kMax, kMax},
                                                              {0, 0, -1, -1},
                                                              {kMax, kMax, kMin, kMin}}};
    for (const auto& box : windows) {
        std::string bytes = exr;
        std::memcpy(bytes.data() + window, box.data(), sizeof box);
        add(fmt::format("{}.exr", hostile.size()), bytes);
    }
    std::string long_attribute = exr;
    std::memcpy(long_attribute.data() + window - 4, &kMax, 4);
    add("long.exr", long_attribute);
    // OpenEXR finds the end of the channel list by itself; a reader that trusts its size of 0 never sees the data
    // window.
    std::string lost_window = exr;
    const std::array<std::int32_t, 4> wide{0, 0, 9'999'999, 63};
    std::memcpy(lost_window.data() + window, &wide, sizeof wide);
    std::memset(lost_window.data() + exr.find("chlist") + sizeof "chlist", 0, 4);
    add("lost.exr", lost_window);

    for (const fs::path& path : hostile) {
        const long taken = memory_to_refuse(path);
        EXPECT_GE(taken, 0) << path << " was read";
        EXPECT_LT(taken, 512) << path << ": " << refusal(path);
    }
}

TEST(Texture, RefusesWhatIsBrokenOrTooLargeByName) {
    const ScratchFolder folder;
    write_image(folder / "wide.png", Image(kMaxTextureSide + 1, 1), {});
    EXPECT_EQ(refusal(folder / "wide.png"), "");
    EXPECT_THROW(read_texture(folder / "wide.png"), InputError);
    write_image(folder / "widest.png", Image(kMaxTextureSide, 1), {});
    EXPECT_EQ(read_texture(folder / "widest.png").width, kMaxTextureSide);

    set_file_text(folder / "text.png", "text");
    try {
        read_texture(folder / "text.png");
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_EQ(error.what(), (folder / "text.png").string() + ": cannot read: not a PNG file");
    }
    // A hole of a terabyte takes no disk: only the size says that it cannot be read.
    std::filesystem::resize_file(folder / "text.png", std::uintmax_t{1} << 40U);
    EXPECT_THROW(read_texture(folder / "text.png"), InputError);
    const std::uintmax_t most = (std::uintmax_t{1} << 20U) + 9 * kMaxTextureSide;
    std::filesystem::resize_file(folder / "widest.png", most);  // what follows the image is not read
    EXPECT_EQ(read_texture(folder / "widest.png", kMaxTextureSide).width, kMaxTextureSide);
    std::filesystem::resize_file(folder / "widest.png", most + 1);
    EXPECT_THROW(read_texture(folder / "widest.png", kMaxTextureSide), InputError);
    EXPECT_THROW(read_texture(folder / "absent.png"), InputError);
    EXPECT_THROW(read_texture(folder.path()), InputError);
}

}  // namespace
}  // namespace raypool
