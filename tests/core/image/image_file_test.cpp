#include "core/image/image_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/error.h"
#include "core/image/srgb.h"
#include "tests/core/image/image_samples.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;

TEST(Srgb, FollowsTheStandardsCurve) {
    EXPECT_EQ(srgb_from_linear(0), 0);
    EXPECT_EQ(linear_from_srgb(0), 0);
    EXPECT_NEAR(srgb_from_linear(1), 1, 1e-15);
    EXPECT_NEAR(linear_from_srgb(1), 1, 1e-15);
    EXPECT_DOUBLE_EQ(srgb_from_linear(0.001), 0.01292);
    EXPECT_DOUBLE_EQ(linear_from_srgb(0.02), 0.02 / 12.92);
    EXPECT_NEAR(srgb_from_linear(0.18), 0.461356129500, 1e-10);
    EXPECT_NEAR(srgb_from_linear(0.5), 0.735356983052, 1e-10);
    EXPECT_NEAR(linear_from_srgb(0.5), 0.214041140482, 1e-10);
    for (int i = 0; i <= 1024; ++i) EXPECT_NEAR(linear_from_srgb(srgb_from_linear(i / 1024.0)), i / 1024.0, 1e-7);
}

TEST(ImageFile, FormatIsTheExtensionInEitherCase) {
    EXPECT_EQ(image_format("a/b.png"), ImageFormat::Png);
    EXPECT_EQ(image_format("b.tar.EXR"), ImageFormat::Exr);
    EXPECT_EQ(image_format("b.Pfm"), ImageFormat::Pfm);
    for (const char* path : {"a.jpg", "png", ".png", "a.png/b", "a.png ", ""}) {
        try {
            image_format(path);
            ADD_FAILURE() << path;
        } catch (const InputError& error) {
            EXPECT_EQ(error.what(), std::string(path) + ": an image file's name must end in .png, .exr or .pfm");
        }
    }
}

TEST(ImageFile, ExrAndPfmKeepEveryBit) {
    const ScratchFolder folder;
    const std::array<std::array<std::int64_t, 2>, 5> sizes{{{1, 1}, {7, 5}, {1, 300}, {300, 1}, {19, 600}}};
    for (const auto& [width, height] : sizes) {
        for (const char* name : {"a.exr", "a.pfm"}) {
            const Image image = wild_image(width, height);
            write_image(folder / name, image, kAttributes);
            EXPECT_TRUE(same_bits(read_image(folder / name), image)) << name << ' ' << width << 'x' << height;
        }
    }
}

TEST(ImageFile, PngIsWithinHalfACodeValueAndClampsTheRest) {
    const ScratchFolder folder;
    Image image(1000, 1);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<float>(i) / 2999.0F;
    write_image(folder / "a.png", image, {});
    const Image read = read_image(folder / "a.png");
    ASSERT_EQ(read.rgb.size(), image.rgb.size());
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        EXPECT_LE(std::abs(srgb_from_linear(read.rgb[i]) - srgb_from_linear(image.rgb[i])), 0.5 / 255 + 1e-6) << i;
    }

    const float infinity = std::numeric_limits<float>::infinity();
    Image odd(2, 1);
    odd.rgb = {std::numeric_limits<float>::quiet_NaN(), -1, -infinity, 1.5F, infinity, 1e30F};
    write_image(folder / "odd.png", odd, {});
    EXPECT_EQ(read_image(folder / "odd.png").rgb, (std::vector<float>{0, 0, 0, 1, 1, 1}));
}

TEST(ImageFile, EveryPngCodeMeansTheSrgbCurveAndComesBackAsItself) {
    const ScratchFolder folder;
    std::vector<png_byte> codes(std::size_t{256} * 3);
    for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = static_cast<png_byte>(i / 3);
    set_file_text(folder / "a.png", png_of(256, 1, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, 0, {codes}));
    const Image image = read_image(folder / "a.png");
    for (int i = 0; i < 256; ++i) EXPECT_EQ(image.pixel(i, 0)[1], static_cast<float>(linear_from_srgb(i / 255.0)));
    write_image(folder / "b.png", image, {});
    EXPECT_TRUE(same_bits(read_image(folder / "b.png"), image));
}

TEST(ImageFile, RowZeroIsTheTopRowInEveryFormat) {
    const ScratchFolder folder;
    Image image(1, 2);
    image.pixel(0, 0)[0] = 1;
    image.pixel(0, 1)[2] = 1;
    for (const char* name : {"a.png", "a.exr", "a.pfm"}) {
        write_image(folder / name, image, {});
        EXPECT_TRUE(same_bits(read_image(folder / name), image)) << name;
    }
    const std::string pfm = file_text(folder / "a.pfm");
    float first = -1;
    std::memcpy(&first, pfm.data() + std::strlen("PF\n1 2\n-1.0\n"), sizeof first);
    EXPECT_EQ(first, 0);  // the bottom row comes first in the file
    std::string png = file_text(folder / "a.png");
    std::array<png_byte, 6> codes{};
    png_image reader{};
    reader.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_memory(&reader, png.data(), png.size()));
    reader.format = PNG_FORMAT_RGB;
    ASSERT_TRUE(png_image_finish_read(&reader, nullptr, codes.data(), 0, nullptr));
    EXPECT_EQ(codes, (std::array<png_byte, 6>{255, 0, 0, 0, 0, 255}));
}

TEST(ImageFile, BytesDependOnImageAndAttributesOnly) {
    const ScratchFolder folder;
    const Image image = wild_image(20, 20);
    for (const char* extension : {".png", ".exr", ".pfm"}) {
        write_image(folder / (std::string("a") + extension), image, kAttributes);
        write_image(folder / (std::string("b") + extension), image, kAttributes);
        EXPECT_EQ(file_text(folder / (std::string("a") + extension)),
                  file_text(folder / (std::string("b") + extension)));
    }
}

TEST(ImageFile, ExrAttributesComeBackAsTheyWere) {
    const ScratchFolder folder;
    ImageAttributes attributes = kAttributes;
    attributes["raypool.empty"] = "";
    attributes["raypool.text"] = "two\nlines, \xc3\xa9 and \"quotes\"";
    attributes["raypool.a_name_longer_than_31_characters"] = std::string(100'000, 'x');
    write_image(folder / "a.exr", wild_image(3, 3), attributes);
    EXPECT_EQ(read_image_contents(folder / "a.exr").attributes, attributes);
}

TEST(ImageFile, PngCarriesTheSrgbChunkAndAttributesAsText) {
    const ScratchFolder folder;
    write_image(folder / "a.png", wild_image(3, 3), {{"raypool.hash", "abc"}, {"raypool.scene", "caf\xc3\xa9"}});
    const std::string bytes = file_text(folder / "a.png");
    EXPECT_NE(bytes.find("sRGB"), std::string::npos);
    EXPECT_NE(bytes.find(std::string("tEXtraypool.hash") + '\0' + "abc"), std::string::npos);
    EXPECT_NE(bytes.find(std::string("iTXtraypool.scene") + '\0'), std::string::npos);
    EXPECT_NE(bytes.find("caf\xc3\xa9"), std::string::npos);
}

TEST(ImageFile, ReadsEveryKindOfPng) {
    const ScratchFolder folder;
    const auto read = [&](const std::string& bytes) {
        set_file_text(folder / "a.png", bytes);
        return read_image(folder / "a.png").rgb;
    };
    const auto linear = [](double coded) { return static_cast<float>(linear_from_srgb(coded)); };
    const float half = linear(128 / 255.0);
    const int none = PNG_INTERLACE_NONE;

    EXPECT_EQ(read(png_of(2, 1, 8, PNG_COLOR_TYPE_GRAY, none, 0, {{128, 255}})),
              (std::vector<float>{half, half, half, 1, 1, 1}));
    EXPECT_EQ(read(png_of(2, 1, 1, PNG_COLOR_TYPE_GRAY, none, 0, {{0x40}})), (std::vector<float>{0, 0, 0, 1, 1, 1}));
    EXPECT_EQ(read(png_of(2, 1, 8, PNG_COLOR_TYPE_PALETTE, none, 0, {{0, 1}})),
              (std::vector<float>{1, 0, 0, 0, half, 1}));
    // Alpha is dropped, not blended.
    EXPECT_EQ(read(png_of(1, 1, 8, PNG_COLOR_TYPE_RGBA, none, 0, {{255, 128, 0, 3}})),
              (std::vector<float>{1, half, 0}));
    EXPECT_EQ(read(png_of(1, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, none, 0, {{128, 0}})),
              (std::vector<float>{half, half, half}));
    // All 16 bits count.
    EXPECT_EQ(read(png_of(1, 1, 16, PNG_COLOR_TYPE_RGB, none, 0, {{0x80, 0x01, 0xff, 0xff, 0, 1}})),
              (std::vector<float>{linear(0x8001 / 65535.0), 1, linear(1 / 65535.0)}));
    // A gAMA chunk is believed, unless it is the approximation of sRGB.
    EXPECT_EQ(read(png_of(1, 1, 8, PNG_COLOR_TYPE_RGB, none, 1.0, {{51, 128, 255}})),
              (std::vector<float>{0.2F, static_cast<float>(128 / 255.0), 1}));
    EXPECT_EQ(read(png_of(1, 1, 8, PNG_COLOR_TYPE_RGB, none, 0.45455, {{0, 128, 255}})),
              (std::vector<float>{0, half, 1}));

    std::vector<std::vector<png_byte>> rows(9, std::vector<png_byte>(33));
    for (std::size_t i = 0; i < std::size_t{9} * 33; ++i) rows[i / 33][i % 33] = static_cast<png_byte>(i * 7);
    EXPECT_EQ(read(png_of(11, 9, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_ADAM7, 0, rows)),
              read(png_of(11, 9, 8, PNG_COLOR_TYPE_RGB, none, 0, rows)));
}

TEST(ImageFile, ReadsPfmInBothByteOrders) {
    const ScratchFolder folder;
    set_file_text(folder / "little.pfm", std::string("PF\n1 1\n-1.0\n\0\0\x80\x3f\0\0\0\x40\0\0\0\xc0", 24));
    set_file_text(folder / "big.pfm", std::string("PF 1 1 1.0\n\x3f\x80\0\0\x40\0\0\0\xc0\0\0\0", 23));
    EXPECT_EQ(read_image(folder / "little.pfm").rgb, (std::vector<float>{1, 2, -2}));
    EXPECT_EQ(read_image(folder / "big.pfm").rgb, (std::vector<float>{1, 2, -2}));
}

TEST(ImageFile, ReadsGreyPfmAndEveryHeaderThatReadersAgreeOn) {
    const ScratchFolder folder;
    const std::string colour("\0\0\x80\x3f\0\0\0\x40\0\0\0\xc0", 12);
    const std::string grey("\x0a\0\x80\x3f\0\0\0\x40", 8);  // begins like a line feed
    const auto read = [&](const std::string& bytes) {
        set_file_text(folder / "a.pfm", bytes);
        return read_image(folder / "a.pfm").rgb;
    };
    const float first = std::bit_cast<float>(0x3f80000aU);
    const std::vector<float> colours{1, 2, -2}, greys{first, first, first, 2, 2, 2};
    for (const char* header : {"PF\n1 1\n-1\n", "PF\r\n1 1\r\n-1.0\r\n", "PF 1  1\t-1 ", "PF\n\n1\n1\n\n-1\n",
                               "PF\n# made by hand\n1 1 # one\n#\n-1\n", "PF\n1 1\n-1\r"}) {
        EXPECT_EQ(read(header + colour), colours) << header;
    }
    for (const char* header : {"Pf\n2 1\n-1\n", "Pf\r\n2 1\r\n-1\r\n", "Pf 2 1 -1\r"}) {
        EXPECT_EQ(read(header + grey), greys) << header;
    }
    // Two grey rows, the bottom one first, in the other byte order.
    EXPECT_EQ(read(std::string("Pf\n1 2\n1\n\x3f\x80\0\0\x40\0\0\0", 17)), (std::vector<float>{2, 2, 2, 1, 1, 1}));
}

TEST(ImageFile, ReadsHalfFloatsAndExtraChannelsAndShiftedWindowsOfExr) {
    const ScratchFolder folder;
    const fs::path path = folder / "a.exr";
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::RLE_COMPRESSION}) {
        Imf::Header header(2, 1);
        header.compression() = compression;
        header.dataWindow().min.x = -3;
        header.dataWindow().max.x = -2;
        header.dataWindow().min.y = header.dataWindow().max.y = 1000;
        for (const char* name : {"A", "B", "G", "R"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
        // 0.5, 4, 3, 2 and 0.5, 7, 6, 5 as half floats
        const std::array<std::uint16_t, 8> values{0x3800, 0x4400, 0x4200, 0x4000, 0x3800, 0x4700, 0x4600, 0x4500};
        {
            Imf::FrameBuffer buffer;
            for (std::size_t i = 0; i < 4; ++i) {
                const auto& window = header.dataWindow();
                const std::array<const char*, 4> names{"A", "B", "G", "R"};
                buffer.insert(names[i], Imf::Slice::Make(Imf::HALF, &values[i], window, 8, 16));
            }
            Imf::OutputFile file(path.c_str(), header);
            file.setFrameBuffer(buffer);
            file.writePixels(1);
        }
        EXPECT_EQ(read_image(path).rgb, (std::vector<float>{2, 3, 4, 5, 6, 7}));
    }
}

TEST(ImageContents, TellThePrimariesOfAPngThatAreNotThoseOfSrgb) {
    const ScratchFolder folder;
    const auto read = [&](const std::array<std::uint32_t, 8>& hundred_thousandths) {  // white first
        std::string chunk = "cHRM";
        for (const std::uint32_t value : hundred_thousandths)
            for (int shift = 24; shift >= 0; shift -= 8) chunk += static_cast<char>(value >> shift);
        const auto sum = static_cast<std::uint32_t>(
            crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size())));
        for (int shift = 24; shift >= 0; shift -= 8) chunk += static_cast<char>(sum >> shift);
        constexpr std::size_t kEndOfHeader = 33;
        std::string bytes = png_of(1, 1, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, 0, {{255, 128, 0}});
        bytes.insert(kEndOfHeader, std::string("\0\0\0\x20", 4) + chunk);
        set_file_text(folder / "a.png", bytes);
        return read_image_contents(folder / "a.png").primaries;
    };
    EXPECT_EQ(read({31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000}), "sRGB");
    EXPECT_EQ(read({31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600}),
              "red 0.708 0.292, green 0.17 0.797, blue 0.131 0.046, white 0.3127 0.329");
}

TEST(Texture, IsThePngInLinearLight) {
    const ScratchFolder folder;
    set_file_text(folder / "a.png",
                  png_of(1, 2, 8, PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE, 0, {{255, 0, 128, 7}, {1, 2, 3, 255}}));
    const auto texels = read_texture(folder / "a.png");
    EXPECT_EQ(texels.width, 1);
    EXPECT_EQ(texels.height, 2);
    EXPECT_EQ(texels.rgb, read_image(folder / "a.png").rgb);
    EXPECT_EQ(texels.rgb[0], 1);
}

TEST(Pfm, GreyAndLinesThatEndInTwoBytesAreRead) {
    const ScratchFolder folder;
    set_file_text(folder / "grey.pfm", std::string("Pf\n2 1\n-1.0\n\0\0\x80\x3f\0\0\0\x40", 20));
    EXPECT_EQ(read_image(folder / "grey.pfm").rgb, (std::vector<float>{1, 1, 1, 2, 2, 2}));
    set_file_text(folder / "grey_big.pfm", std::string("Pf\n2 1\n1.0\n\x3f\x80\0\0\x40\0\0\0", 19));
    EXPECT_EQ(read_image(folder / "grey_big.pfm").rgb, (std::vector<float>{1, 1, 1, 2, 2, 2}));
    set_file_text(folder / "lines.pfm", std::string("PF\r\n1 1\r\n-1.0\r\n\0\0\x80\x3f\0\0\0\x40\0\0\0\xc0", 27));
    EXPECT_EQ(read_image(folder / "lines.pfm").rgb, (std::vector<float>{1, 2, -2}));
}

}  // namespace
}  // namespace raypool
