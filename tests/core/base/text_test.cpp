#include "core/base/text.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/json_file.h"
#include "core/image/image_file.h"
#include "core/runtime/trace.h"
#include "tests/scratch_folder.h"

namespace raypool {
namespace {

constexpr const char* kReplaced = "\xEF\xBF\xBD";

/// What is no UTF-8, byte by byte: stray and missing continuations, overlong forms, surrogates, too large, never used.
const std::vector<std::string> kInvalid{"\x80",     "\xBF",         "\xC3",         "\xE2\x82",     "\xF0\x9F\x98",
                                        "\xC0\x80", "\xE0\x80\xAF", "\xED\xA0\x80", "\xED\xBF\xBF", "\xF4\x90\x80\x80",
                                        "\xFE",     "\xFF"};
const std::vector<std::string> kValid{
    "", "plain", "é", "中", "😀", "\xED\x9F\xBF", "\xEE\x80\x80", "\xF4\x8F\xBF\xBF", "a\\b\"'"};

TEST(Utf8, LeavesValidTextAsItIs) {
    for (const std::string& text : kValid) EXPECT_EQ(valid_utf8(text), text);
    EXPECT_EQ(valid_utf8(std::string("\0\x1b\n", 3)), std::string("\0\x1b\n", 3));
}

TEST(Utf8, ReplacesEachByteThatIsNoPartOfACharacter) {
    for (const std::string& text : kInvalid) {
        std::string expected = "<";
        for (std::size_t i = 0; i < text.size(); ++i) expected += kReplaced;
        EXPECT_EQ(valid_utf8("<" + text + ">"), expected + ">");
    }
    EXPECT_EQ(valid_utf8("caf\xC3\xA9\xC3"), std::string("café") + kReplaced);
}

TEST(Printable, LeavesWhatATerminalShows) {
    for (const std::string& text : kValid) EXPECT_EQ(printable(text), text);
}

TEST(Printable, EscapesWhatATerminalObeys) {
    EXPECT_EQ(printable("\x1b[2J"), "\\x1b[2J");
    EXPECT_EQ(printable(std::string("a\0b\nc\rd\te\x7f", 10)), "a\\x00b\\x0ac\\x0dd\\x09e\\x7f");
    EXPECT_EQ(printable("\xC2\x9B"), "\\u009b");                         // CSI in Latin-1
    EXPECT_EQ(printable("\xE2\x80\xAE\xE2\x81\xA9"), "\\u202e\\u2069");  // the other way round, and back
    EXPECT_EQ(printable("\xE2\x80\xA8"), "\\u2028");
    EXPECT_EQ(printable("bad\xff.json"), "bad\\xff.json");
}

TEST(Printable, TextIsOneLineOfUtf8WhateverTheBytes) {
    std::string all;
    for (int i = 0; i < 256; ++i)
        for (int j = 0; j < 256; ++j) all += {static_cast<char>(i), static_cast<char>(j)};
    const std::string shown = printable(all);
    EXPECT_EQ(valid_utf8(shown), shown);
    for (const char c : shown) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F);
}

TEST(ShellWord, IsPlainWhereItMayBeAndQuotedElsewhere) {
    EXPECT_EQ(shell_word("scenes/a_1.json"), "scenes/a_1.json");
    EXPECT_EQ(shell_word("my scene.json"), "'my scene.json'");
    EXPECT_EQ(shell_word("it's $HOME"), "'it'\\''s $HOME'");
    EXPECT_EQ(shell_word("é"), "'é'");
    EXPECT_EQ(shell_word(""), "''");
    EXPECT_EQ(shell_word("bad\xff's\n"), "$'bad\\xff\\x27s\\x0a'");
}

TEST(JsonText, NeverThrowsForWhatStringsAndKeysHold) {
    for (const std::string& text : kInvalid) {
        const std::string written = json_text({{text, text}});
        EXPECT_EQ(valid_utf8(written), written);
        EXPECT_TRUE(nlohmann::json::accept(written));
    }
    EXPECT_EQ(json_text({{"a", "é"}}, JsonLayout::OneLine), "{\"a\":\"é\"}");
}

TEST(JsonText, OfATraceNeverThrows) {
    const ScratchFolder folder;
    Trace trace;
    trace.begin(0, 1);
    write_trace(folder.path() / "t.json", trace, {{"scene", "bad\xff"}});
    std::ifstream file(folder.path() / "t.json");
    EXPECT_EQ(nlohmann::json::parse(file).at("otherData").at("scene"), std::string("bad") + kReplaced);
}

TEST(ImageAttributes, AreWrittenAsUtf8) {
    const ScratchFolder folder;
    Image image;
    image.width = image.height = 1;
    image.rgb = {0, 0, 0};
    for (const char* name : {"a.exr", "a.png"}) write_image(folder.path() / name, image, {{"scene", "bad\xff"}});
    EXPECT_EQ(read_image_contents(folder.path() / "a.exr").attributes.at("scene"), std::string("bad") + kReplaced);
}

}  // namespace
}  // namespace raypool
