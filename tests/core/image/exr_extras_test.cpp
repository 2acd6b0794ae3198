/// What an EXR file has beside its picture, and half precision, as OpenEXR reads them.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfRgba.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/image/image_file.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

constexpr int kColumns = 5, kRows = 37;  // more than a block of rows

TEST(ExrExtras, AreWrittenBesideThePicture) {
    const ScratchFolder folder;
    Image image(kColumns, kRows);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = 1 + 0.1F * static_cast<float>(i);
    std::vector<float> depth;
    for (int i = 0; i < kColumns * kRows; ++i) depth.push_back(1 / (1 + static_cast<float>(i)));
    const std::vector<ImageChannel> channels{{"Z", depth, false}, {"albedo.R", depth, true}};
    for (const bool is_half : {false, true}) {
        write_image(folder / "extras.exr", ImageFormat::Exr, image, {{"raypool.hash", "abc"}}, {channels, is_half});
        const ImageContents contents = read_image_contents(folder / "extras.exr");
        EXPECT_EQ(contents.left_out, (std::vector<std::string>{"channel Z", "channel albedo.R"}));
        EXPECT_EQ(contents.attributes.at("raypool.hash"), "abc");
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            EXPECT_EQ(contents.image.rgb[i], is_half ? static_cast<float>(half(image.rgb[i])) : image.rgb[i]);

        Imf::MultiPartInputFile file((folder / "extras.exr").c_str());
        Imf::InputPart part(file, 0);
        const auto type_of = [&](const char* name) { return part.header().channels().findChannel(name)->type; };
        EXPECT_EQ(type_of("G"), is_half ? Imf::HALF : Imf::FLOAT);
        EXPECT_EQ(type_of("albedo.R"), is_half ? Imf::HALF : Imf::FLOAT);
        EXPECT_EQ(type_of("Z"), Imf::FLOAT);
        std::vector<float> read(depth.size());
        for (const bool may_be_half : {false, true}) {
            Imf::FrameBuffer buffer;
            buffer.insert(may_be_half ? "albedo.R" : "Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(read.data()),
                                                                     sizeof(float), kColumns * sizeof(float)));
            part.setFrameBuffer(buffer);
            part.readPixels(0, kRows - 1);
            for (std::size_t i = 0; i < read.size(); ++i)
                EXPECT_EQ(read[i], is_half && may_be_half ? static_cast<float>(half(depth[i])) : depth[i]);
        }
    }
}

}  // namespace
}  // namespace raypool
