/// The kinds of EXR file that other programs write: tiles, parts, layers, luminance, many channels, odd attributes.

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOpaqueAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <bit>
#include <string>
#include <vector>

#include "core/image/image_file.h"
#include "tests/core/image/image_samples.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Channels = std::vector<std::string>;

constexpr int kWidth = 5, kHeight = 7;

/// The value of a channel at a place of the file, so that each channel is known by its values.
float value_of(std::size_t channel, int place) {
    return static_cast<float>(1000 * (channel + 1)) + static_cast<float>(place);
}

/// Float channels of an image of kWidth x kHeight.
struct Planes {
    explicit Planes(const Channels& channels) : values(channels.size()) {
        for (std::size_t c = 0; c < channels.size(); ++c) {
            for (int i = 0; i < kWidth * kHeight; ++i) values[c].push_back(value_of(c, i));
            buffer.insert(channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values[c].data()), sizeof(float),
                                                  kWidth * sizeof(float)));
        }
    }
    std::vector<std::vector<float>> values;
    Imf::FrameBuffer buffer;
};

Imf::Header header_of(const Channels& channels) {
    Imf::Header header(kWidth, kHeight);
    for (const std::string& channel : channels) header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    return header;
}

void write_lines(const fs::path& path, const Imf::Header& header, const Channels& channels) {
    Planes planes(channels);
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(planes.buffer);
    file.writePixels(kHeight);
}

/// Whether an image has these channels of value_of() as red, green and blue.
bool holds(const Image& image, std::size_t red, std::size_t green, std::size_t blue) {
    if (image.width != kWidth || image.height != kHeight) return false;
    for (int i = 0; i < kWidth * kHeight; ++i) {
        const float* pixel = &image.rgb[static_cast<std::size_t>(3 * i)];
        if (pixel[0] != value_of(red, i) || pixel[1] != value_of(green, i) || pixel[2] != value_of(blue, i))
            return false;
    }
    return true;
}

TEST(ExrKinds, TilesOfEverySizeAndLevelAreRead) {
    const ScratchFolder folder;
    const Channels channels{"R", "G", "B"};
    for (const unsigned edge : {1U, 2U, 3U, 64U}) {
        for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
            Imf::Header header = header_of(channels);
            header.setTileDescription(Imf::TileDescription(edge, edge + 1, mode));
            Planes planes(channels);
            {
                Imf::TiledOutputFile file((folder / "a.exr").c_str(), header);
                for (int level = 0; level < file.numLevels(); ++level) {
                    file.setFrameBuffer(planes.buffer);
                    file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
                }
            }
            EXPECT_TRUE(holds(read_image(folder / "a.exr"), 0, 1, 2)) << edge << " " << mode;
        }
    }
}

TEST(ExrKinds, OfSeveralPartsTheFirstInColourIsReadAndTheOthersAreNamed) {
    const ScratchFolder folder;
    const std::vector<Channels> parts{{"Z"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    std::vector<Imf::Header> headers;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        headers.push_back(header_of(parts[i]));
        headers.back().setName("part" + std::to_string(i));
        headers.back().setType(Imf::SCANLINEIMAGE);
    }
    {
        Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), static_cast<int>(headers.size()));
        for (std::size_t i = 0; i < parts.size(); ++i) {
            Planes planes(parts[i]);
            Imf::OutputPart part(file, static_cast<int>(i));
            part.setFrameBuffer(planes.buffer);
            part.writePixels(kHeight);
        }
    }
    const ImageContents contents = read_image_contents(folder / "a.exr");
    EXPECT_TRUE(holds(contents.image, 0, 1, 2));
    EXPECT_EQ(contents.left_out, (std::vector<std::string>{"part part0", "part part2"}));
}

TEST(ExrKinds, LuminanceAloneIsGrey) {
    const ScratchFolder folder;
    write_lines(folder / "a.exr", header_of({"Y", "A"}), {"Y", "A"});
    const ImageContents contents = read_image_contents(folder / "a.exr");
    EXPECT_TRUE(holds(contents.image, 0, 0, 0));
    EXPECT_EQ(contents.left_out, std::vector<std::string>{"channel A"});
}

TEST(ExrKinds, LuminanceWithChromaIsInColour) {
    const ScratchFolder folder;
    constexpr int kEven = 6;  // chroma has half as many pixels either way
    std::vector<Imf::Rgba> pixels(kEven * kEven, Imf::Rgba(0.5F, 0.25F, 1));
    {
        Imf::RgbaOutputFile file((folder / "a.exr").c_str(), kEven, kEven, Imf::WRITE_YC);
        file.setFrameBuffer(pixels.data(), 1, kEven);
        file.writePixels(kEven);
    }
    const ImageContents contents = read_image_contents(folder / "a.exr");
    ASSERT_EQ(contents.image.rgb.size(), 3U * kEven * kEven);
    for (std::size_t i = 0; i < contents.image.rgb.size(); ++i)
        EXPECT_NEAR(contents.image.rgb[i], i % 3 == 0 ? 0.5F : i % 3 == 1 ? 0.25F : 1, 0.01F);
    EXPECT_TRUE(contents.left_out.empty());
}

TEST(ExrKinds, OfLayersTheOneWithoutANameIsReadElseTheFirst) {
    const ScratchFolder folder;
    const Channels one{"beauty.R", "beauty.G", "beauty.B"};
    write_lines(folder / "one.exr", header_of(one), one);
    EXPECT_TRUE(holds(read_image(folder / "one.exr"), 0, 1, 2));

    const Channels many{"a.b.R", "a.b.G", "a.b.B", "R", "G", "B", "xR"};
    write_lines(folder / "many.exr", header_of(many), many);
    const ImageContents contents = read_image_contents(folder / "many.exr");
    EXPECT_TRUE(holds(contents.image, 3, 4, 5));
    EXPECT_EQ(contents.left_out,
              (std::vector<std::string>{"channel a.b.B", "channel a.b.G", "channel a.b.R", "channel xR"}));
}

TEST(ExrKinds, ManyChannelsOfAWideImageAreRead) {
    const ScratchFolder folder;
    constexpr int kWide = 7680;
    Imf::Header header(kWide, 1);
    const std::vector<float> row(kWide, 0.5F);
    Imf::FrameBuffer buffer;
    const auto add = [&](const std::string& name) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        buffer.insert(name, Imf::Slice(Imf::FLOAT, const_cast<char*>(reinterpret_cast<const char*>(row.data())),
                                       sizeof(float), kWide * sizeof(float)));
    };
    for (const char* name : {"R", "G", "B"}) add(name);
    for (int i = 3; i < 140; ++i) add("light" + std::to_string(i));
    {
        Imf::OutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(1);
    }
    const ImageContents contents = read_image_contents(folder / "a.exr");
    EXPECT_EQ(contents.image.rgb, std::vector<float>(3 * kWide, 0.5F));
    EXPECT_EQ(contents.left_out.size(), 137U);
}

TEST(ExrKinds, AttributesOfUnknownTypesArePassedOver) {
    const ScratchFolder folder;
    const Channels channels{"R", "G", "B"};
    Imf::Header header = header_of(channels);
    header.insert("somebodys", Imf::OpaqueAttribute("a_type_of_theirs"));
    write_lines(folder / "a.exr", header, channels);
    EXPECT_TRUE(holds(read_image(folder / "a.exr"), 0, 1, 2));
}

TEST(ExrKinds, ManyChannelsOfAWideImageAreReadInTallBlocks) {
    const ScratchFolder folder;
    constexpr int kWide = 7680;
    Imf::Header header(kWide, 1);
    header.compression() = Imf::DWAB_COMPRESSION;  // 256 rows together, of more than 1 GiB
    const Image noise = wild_image(kWide, 47);
    const auto values_of = [&](int channel) { return noise.rgb.data() + channel * kWide; };
    Imf::FrameBuffer buffer;
    for (int i = 0; i < 140; ++i) {
        const std::string name = i < 3 ? std::string(1, "RGB"[i]) : "light" + std::to_string(i);
        header.channels().insert(name, Imf::Channel(Imf::UINT));  // kept to the bit, and so not compressed away
        buffer.insert(name, Imf::Slice::Make(Imf::UINT, values_of(i), header.dataWindow(), sizeof(float)));
    }
    {
        Imf::OutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(1);
    }
    const Image image = read_image(folder / "a.exr");
    ASSERT_EQ(image.rgb.size(), 3U * kWide);
    for (int i = 0; i < 3 * kWide; ++i)
        ASSERT_EQ(image.rgb[static_cast<std::size_t>(i)],
                  static_cast<float>(std::bit_cast<std::uint32_t>(values_of(i % 3)[i / 3])));
}

TEST(ExrKinds, AttributesThatVersionsOfOpenExrReadInDifferentWaysArePassedOver) {
    const ScratchFolder folder;
    const Channels channels{"R", "G", "B"};
    Imf::Header header = header_of(channels);
    header.insert("attribute_of_theirs", Imf::StringAttribute("anything at all"));
    header.insert("own", Imf::StringAttribute("text"));
    write_lines(folder / "a.exr", header, channels);
    const std::string written = file_text(folder / "a.exr");
    const std::string old = "attribute_of_theirs" + std::string("\0string", 7);
    for (const std::string type : {"studio", "bytes", "idmanifest"}) {
        std::string bytes = written;
        const std::size_t place = bytes.find(old);
        ASSERT_NE(place, std::string::npos);
        bytes.replace(place, old.size(), std::string(old.size() - 1 - type.size(), 'a') + '\0' + type);
        set_file_text(folder / "a.exr", bytes);
        const ImageContents contents = read_image_contents(folder / "a.exr");
        EXPECT_TRUE(holds(contents.image, 0, 1, 2)) << type;
        EXPECT_EQ(contents.attributes, (ImageAttributes{{"own", "text"}})) << type;
    }
}

TEST(ExrKinds, WindowsAndPrimariesAreTold) {
    const ScratchFolder folder;
    const Channels channels{"R", "G", "B"};
    Imf::Header header = header_of(channels);
    write_lines(folder / "plain.exr", header, channels);
    const ImageContents plain = read_image_contents(folder / "plain.exr");
    EXPECT_EQ(plain.data_window, (PixelWindow{0, kWidth, 0, kHeight}));
    EXPECT_EQ(plain.display_window, plain.data_window);
    EXPECT_EQ(plain.primaries, "sRGB");

    Imf::Chromaticities wide;
    wide.red.x = 0.708F;
    Imf::addChromaticities(header, wide);
    header.displayWindow().min.x = -2;
    header.displayWindow().max.y = 99;
    write_lines(folder / "odd.exr", header, channels);
    const ImageContents odd = read_image_contents(folder / "odd.exr");
    EXPECT_EQ(odd.data_window, plain.data_window);
    EXPECT_EQ(odd.display_window, (PixelWindow{-2, kWidth, 0, 100}));
    EXPECT_NE(odd.primaries.find("red 0.708"), std::string::npos) << odd.primaries;
}

TEST(ExrKinds, DisplayWindowsThatNoImageFillsAreRefused) {
    const ScratchFolder folder;
    const Channels channels{"R", "G", "B"};
    Imf::Header header = header_of(channels);
    for (const auto& [width, height] : {std::pair{1'000'000'000, 1'000'000'000}, {65537, 1}, {65536, 65536}}) {
        header.displayWindow().max.x = width - 1;
        header.displayWindow().max.y = height - 1;
        write_lines(folder / "wide.exr", header, channels);
        const std::string reason = refusal(folder / "wide.exr");
        EXPECT_EQ(reason.find("width and height of the display window must be within [1, 65536]"), 0U) << reason;
    }
}

TEST(ExrKinds, RefusesWhatHasNoColourOrTilesThatAreNotThere) {
    const ScratchFolder folder;
    write_lines(folder / "depth.exr", header_of({"Z"}), {"Z"});
    EXPECT_EQ(refusal(folder / "depth.exr"),
              "has no channels R, G and B, and no luminance Y, in a part that is not deep");

    // A header that claims a billion tiles in a file of a few hundred bytes.
    Imf::Header header = header_of({"R", "G", "B"});
    header.setTileDescription(Imf::TileDescription(64, 64));
    { Imf::TiledOutputFile file((folder / "tiles.exr").c_str(), header); }
    std::string bytes = file_text(folder / "tiles.exr");
    const std::size_t tile = bytes.find("tiledesc") + sizeof "tiledesc" + 4;
    const std::array<std::uint32_t, 2> smallest{1, 1}, hugest{0x7fffffff, 0x7fffffff};
    std::memcpy(bytes.data() + tile, hugest.data(), sizeof hugest);
    set_file_text(folder / "tiles.exr", bytes);
    EXPECT_NE(refusal(folder / "tiles.exr").find("tiles must have edges"), std::string::npos);
    std::memcpy(bytes.data() + tile, smallest.data(), sizeof smallest);
    const std::array<std::int32_t, 4> window{0, 0, 32767, 32767};
    std::memcpy(bytes.data() + bytes.find("dataWindow") + sizeof "dataWindow" + sizeof "box2i" + 4, window.data(),
                sizeof window);
    set_file_text(folder / "tiles.exr", bytes);
    EXPECT_EQ(refusal(folder / "tiles.exr"), "the file ends too early");
}

}  // namespace
}  // namespace raypool
