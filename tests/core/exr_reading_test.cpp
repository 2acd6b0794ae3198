/// EXR files as other programs write them: tiles, parts, luminance, layers, many channels, attributes of their own.

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <gtest/gtest.h>

#include <bit>
#include <string>
#include <utility>
#include <vector>

#include "core/image_file.h"
#include "tests/core/image_samples.h"
#include "tests/core/scratch_folder.h"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

/// A header with these channels, of floats, and a data window within (or beyond) the display window of 64 x 48.
Imf::Header header_of(const Names& channels, const ImageWindow& data) {
    Imf::Header header(64, 48);
    header.dataWindow().min.x = static_cast<int>(data.min_x);
    header.dataWindow().min.y = static_cast<int>(data.min_y);
    header.dataWindow().max.x = static_cast<int>(data.min_x + data.width - 1);
    header.dataWindow().max.y = static_cast<int>(data.min_y + data.height - 1);
    for (const std::string& name : channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    return header;
}

/// `image`'s red, green and blue as `channels`, in this order; a further channel is red again.
Imf::FrameBuffer pixels_of(const Image& image, const Imf::Header& header, const Names& channels) {
    constexpr std::size_t kPixelBytes = 3 * sizeof(float);
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        buffer.insert(channels[i], Imf::Slice::Make(Imf::FLOAT, image.rgb.data() + i % 3, header.dataWindow(),
                                                    kPixelBytes, kPixelBytes * static_cast<std::size_t>(image.width)));
    }
    return buffer;
}

fs::path write_rows(const fs::path& path, const Image& image, const Imf::Header& header, const Names& channels) {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(pixels_of(image, header, channels));
    file.writePixels(static_cast<int>(image.height));
    return path;
}

const Names kRgb{"R", "G", "B"};

TEST(ExrReading, TilesOfAnySizeAreTheImageThatScanLinesAre) {
    const ScratchFolder folder;
    const Image image = wild_image(37, 29);
    for (const auto& [tile_width, tile_height] : {std::pair{16, 8}, std::pair{64, 64}, std::pair{1, 29}}) {
        for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
            Imf::Header header = header_of(kRgb, {-5, 7, 37, 29});
            header.setTileDescription(Imf::TileDescription(tile_width, tile_height, mode));
            {
                Imf::TiledOutputFile file((folder / "a.exr").c_str(), header);
                file.setFrameBuffer(pixels_of(image, header, kRgb));
                file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
                if (mode == Imf::MIPMAP_LEVELS) {
                    const Image smaller = wild_image(37, 29);
                    for (int level = 1; level < file.numLevels(); ++level) {
                        auto window = file.dataWindowForLevel(level);
                        Imf::Header level_header = header;
                        level_header.dataWindow() = window;
                        file.setFrameBuffer(pixels_of(smaller, level_header, kRgb));
                        file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
                    }
                }
            }
            const ImageContents contents = read_image_contents(folder / "a.exr");
            EXPECT_TRUE(same_bits(contents.image, image)) << tile_width << ' ' << mode;
            EXPECT_EQ(contents.data_window, (ImageWindow{-5, 7, 37, 29}));
            EXPECT_EQ(contents.display_window, (ImageWindow{0, 0, 64, 48}));
        }
    }
}

TEST(ExrReading, ThePictureIsTheFirstPartThatIsOneAndTheOthersAreNamed) {
    const ScratchFolder folder;
    const Image depth = wild_image(3, 2), tiled = wild_image(20, 10), second = wild_image(4, 4);
    std::vector<Imf::Header> headers{header_of({"Z"}, {0, 0, 3, 2}), header_of({"R", "G", "B", "A"}, {1, 2, 20, 10}),
                                     header_of(kRgb, {0, 0, 4, 4})};
    const Names names{"depth", "beauty", "other"};
    for (std::size_t i = 0; i < headers.size(); ++i) {
        headers[i].setName(names[i]);
        headers[i].setType(i == 1 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
    }
    headers[1].setTileDescription(Imf::TileDescription(8, 8));
    headers[1].insert("owner", Imf::StringAttribute("b"));
    {
        Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 3);
        Imf::OutputPart first(file, 0), third(file, 2);
        Imf::TiledOutputPart middle(file, 1);
        first.setFrameBuffer(pixels_of(depth, headers[0], {"Z"}));
        first.writePixels(2);
        middle.setFrameBuffer(pixels_of(tiled, headers[1], {"R", "G", "B", "A"}));
        middle.writeTiles(0, middle.numXTiles() - 1, 0, middle.numYTiles() - 1);
        third.setFrameBuffer(pixels_of(second, headers[2], kRgb));
        third.writePixels(4);
    }
    const ImageContents contents = read_image_contents(folder / "a.exr");
    EXPECT_TRUE(same_bits(contents.image, tiled));
    EXPECT_EQ(contents.data_window, (ImageWindow{1, 2, 20, 10}));
    EXPECT_EQ(contents.unread_channels, (Names{"depth:Z", "A", "other:B", "other:G", "other:R"}));
    EXPECT_EQ(contents.attributes.at("owner"), "b");
}

TEST(ExrReading, LuminanceAloneIsGrey) {
    const ScratchFolder folder;
    const Image image = wild_image(5, 40);
    write_rows(folder / "a.exr", image, header_of({"Y"}, {0, 0, 5, 40}), {"Y"});
    const ImageContents contents = read_image_contents(folder / "a.exr");
    ASSERT_EQ(contents.image.rgb.size(), image.rgb.size());
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(contents.image.rgb[i]),
                  std::bit_cast<std::uint32_t>(image.rgb[i / 3 * 3]));
    }
    EXPECT_TRUE(contents.unread_channels.empty());
}

TEST(ExrReading, LuminanceAndChromaAreTheColoursThatTheyStandFor) {
    const ScratchFolder folder;
    std::vector<Imf::Rgba> pixels(std::size_t{40} * 30, Imf::Rgba(0.75F, 0.5F, 0.25F));
    {
        Imf::Header header = header_of({}, {-4, 6, 40, 30});
        Imf::RgbaOutputFile file((folder / "a.exr").c_str(), header, Imf::WRITE_YCA);
        file.setFrameBuffer(pixels.data() + 4 - 6 * 40, 1, 40);
        file.writePixels(30);
    }
    const ImageContents contents = read_image_contents(folder / "a.exr");
    ASSERT_EQ(contents.image.width, 40);
    ASSERT_EQ(contents.image.height, 30);
    for (std::size_t i = 0; i < contents.image.rgb.size(); i += 3) {
        EXPECT_NEAR(contents.image.rgb[i], 0.75F, 2e-3F);
        EXPECT_NEAR(contents.image.rgb[i + 1], 0.5F, 2e-3F);
        EXPECT_NEAR(contents.image.rgb[i + 2], 0.25F, 2e-3F);
    }
    EXPECT_EQ(contents.data_window, (ImageWindow{-4, 6, 40, 30}));
    EXPECT_EQ(contents.unread_channels, Names{"A"});
}

TEST(ExrReading, TheOnlyLayerOfColoursIsRead) {
    const ScratchFolder folder;
    const Image image = wild_image(6, 5);
    const Names channels{"beauty.R", "beauty.G", "beauty.B", "normal.X", "beauty.A"};
    write_rows(folder / "a.exr", image, header_of(channels, {0, 0, 6, 5}), channels);
    const ImageContents contents = read_image_contents(folder / "a.exr");
    EXPECT_TRUE(same_bits(contents.image, image));
    EXPECT_EQ(contents.unread_channels, (Names{"beauty.A", "normal.X"}));
}

TEST(ExrReading, AmongSeveralLayersTheOneWithoutANameIsRead) {
    const ScratchFolder folder;
    const Image image = wild_image(2, 2);
    const Names channels{"R", "G", "B", "left.view.R", "left.view.G", "left.view.B"};
    write_rows(folder / "plain.exr", image, header_of(channels, {0, 0, 2, 2}), channels);
    EXPECT_TRUE(same_bits(read_image(folder / "plain.exr"), image));

    const Names named{"a.R", "a.G", "a.B", "b.R", "b.G", "b.B"};
    write_rows(folder / "named.exr", image, header_of(named, {0, 0, 2, 2}), named);
    EXPECT_EQ(refusal(folder / "named.exr"),
              "must have R, G and B without a layer's name, or in one layer; got 2 layers, such as a and b");
}

TEST(ExrReading, ManyChannelsOfAWideImageAreNotTooMany) {
    const ScratchFolder folder;
    const Image image = wild_image(7680, 3);
    Names channels = kRgb;
    for (int i = 0; i < 137; ++i) channels.push_back("layer" + std::to_string(i) + ".Z");
    Imf::Header header = header_of(channels, {0, 0, 7680, 3});
    header.compression() = Imf::ZIPS_COMPRESSION;
    write_rows(folder / "a.exr", image, header, channels);
    const ImageContents contents = read_image_contents(folder / "a.exr");
    EXPECT_TRUE(same_bits(contents.image, image));
    EXPECT_EQ(contents.unread_channels.size(), 137U);
}

TEST(ExrReading, WholeNumbersAreTheFloatsOfTheirValue) {
    const ScratchFolder folder;
    Imf::Header header(2, 1);
    const std::vector<std::uint32_t> values{7, 65536};
    Imf::FrameBuffer buffer;
    for (const std::string& name : kRgb) {
        header.channels().insert(name, Imf::Channel(Imf::UINT));
        buffer.insert(name, Imf::Slice::Make(Imf::UINT, values.data(), header.dataWindow()));
    }
    {
        Imf::OutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(1);
    }
    EXPECT_EQ(read_image(folder / "a.exr").rgb, (std::vector<float>{7, 7, 7, 65536, 65536, 65536}));
}

TEST(ExrReading, AnAttributeOfAnUnknownTypeIsSkipped) {
    const ScratchFolder folder;
    const Image image = wild_image(4, 3);
    Imf::Header header = header_of(kRgb, {0, 0, 4, 3});
    header.insert("a_first", Imf::FloatAttribute(1));
    header.insert("own_attribute_1_", Imf::StringAttribute("anything at all"));
    header.insert("p_last", Imf::StringAttribute("text"));
    const std::string written = file_text(write_rows(folder / "a.exr", image, header, kRgb));
    for (const std::string type : {"studio", "bytes", "idmanifest"}) {  // OpenEXR 3.1 misreads idmanifest's size
        std::string bytes = written;
        const std::string name_and_string = "own_attribute_1_" + std::string("\0string", 7);
        const std::size_t place = bytes.find(name_and_string);
        ASSERT_NE(place, std::string::npos);
        const std::size_t name_size = name_and_string.size() - type.size() - 1;
        const std::string both = std::string(name_size, 'o') + '\0' + type;
        bytes.replace(place, both.size(), both);
        set_file_text(folder / "a.exr", bytes);
        const ImageContents contents = read_image_contents(folder / "a.exr");
        EXPECT_TRUE(same_bits(contents.image, image)) << type;
        EXPECT_EQ(contents.attributes, (ImageAttributes{{"p_last", "text"}})) << type;
        EXPECT_EQ(read_exr_attributes(folder / "a.exr"), contents.attributes) << type;
    }
}

TEST(ExrReading, RefusesInOneLineWhatIsNotAPictureOfColours) {
    const ScratchFolder folder;
    const Image image = wild_image(2, 2);
    write_rows(folder / "depth.exr", image, header_of({"Z", "R"}, {0, 0, 2, 2}), {"Z", "R"});
    EXPECT_EQ(refusal(folder / "depth.exr"), "must have channels R, G and B, or Y, in a part that is not deep");

    Imf::Header coarse = header_of({"R", "B"}, {0, 0, 2, 2});
    coarse.channels().insert("G", Imf::Channel(Imf::FLOAT, 2, 2));
    { const Imf::OutputFile file((folder / "coarse.exr").c_str(), coarse); }
    EXPECT_EQ(refusal(folder / "coarse.exr"), "channel G must be sampled every 1 pixels, got 2 x 2");

    Imf::Header deep = header_of(kRgb, {0, 0, 2, 2});
    deep.setType(Imf::DEEPSCANLINE);
    deep.compression() = Imf::ZIPS_COMPRESSION;
    { const Imf::DeepScanLineOutputFile file((folder / "deep.exr").c_str(), deep); }
    EXPECT_EQ(refusal(folder / "deep.exr"), "holds deep data, which is not read");

    Imf::Header tiled = header_of(kRgb, {0, 0, 2, 2});
    tiled.setTileDescription(Imf::TileDescription(2, 2));
    { const Imf::TiledOutputFile file((folder / "tiled.exr").c_str(), tiled); }
    std::string bytes = file_text(folder / "tiled.exr");
    bytes.replace(bytes.find("tiledesc") + 13, 8, std::string("\0\x80\0\0\0\x40\0\0", 8));
    set_file_text(folder / "large_tile.exr", bytes);
    EXPECT_EQ(refusal(folder / "large_tile.exr"),
              "32768 x 16384 pixels of 12 bytes are compressed together: must be at most 256 MiB, or 1024 times the "
              "file");
}

}  // namespace
}  // namespace raypool
