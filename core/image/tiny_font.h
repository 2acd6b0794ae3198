/// A font of 5 x 7 dots for numbers and units in pictures. A letter that no unit uses is blank.
///
/// Two characters stand for others: > for "greater or equal", u for the micro sign.
#pragma once

#include <array>
#include <string_view>

namespace raypool {

inline constexpr int kGlyphWidth = 5;
inline constexpr int kGlyphHeight = 7;  ///< above the base line
inline constexpr int kGlyphRows = 8;    ///< of letters that go below it

struct Glyph {
    char letter;
    std::string_view dots;  ///< row by row from the top, # where ink is
};

inline constexpr std::array kGlyphs = std::to_array<Glyph>({
    {' ', "..... ..... ..... ..... ..... ..... ....."},       {'0', ".###. #...# #..## #.#.# ##..# #...# .###."},
    {'1', "..#.. .##.. ..#.. ..#.. ..#.. ..#.. .###."},       {'2', ".###. #...# ....# ...#. ..#.. .#... #####"},
    {'3', "##### ...#. ..#.. ...#. ....# #...# .###."},       {'4', "...#. ..##. .#.#. #..#. ##### ...#. ...#."},
    {'5', "##### #.... ####. ....# ....# #...# .###."},       {'6', "..##. .#... #.... ####. #...# #...# .###."},
    {'7', "##### ....# ...#. ..#.. .#... .#... .#..."},       {'8', ".###. #...# #...# .###. #...# #...# .###."},
    {'9', ".###. #...# #...# .#### ....# ...#. .##.."},       {'.', "..... ..... ..... ..... ..... .##.. .##.."},
    {'>', ".#... ..#.. ...#. ..#.. .#... ..... ####."},       {'k', "#.... #.... #..#. #.#.. ##... #.#.. #..#."},
    {'M', "#...# ##.## #.#.# #.#.# #...# #...# #...#"},       {'G', ".###. #...# #.... #.### #...# #...# .####"},
    {'e', "..... ..... .###. #...# ##### #.... .###."},       {'s', "..... ..... .###. #.... .###. ....# ####."},
    {'t', ".#... .#... ###.. .#... .#... .#..# ..##."},       {'g', "..... ..... .#### #...# #...# .#### ....# .###."},
    {'m', "..... ..... ##.#. #.#.# #.#.# #...# #...#"},       {'n', "..... ..... #.##. ##..# #...# #...# #...#"},
    {'p', "..... ..... ####. #...# #...# ####. #.... #...."}, {'r', "..... ..... #.##. ##..# #.... #.... #...."},
    {'i', "..#.. ..... .##.. ..#.. ..#.. ..#.. .###."},       {'x', "..... ..... #...# .#.#. ..#.. .#.#. #...#"},
    {'l', ".##.. ..#.. ..#.. ..#.. ..#.. ..#.. .###."},       {'u', "..... ..... #...# #...# #..## ###.# #.... #...."},
});

constexpr const Glyph& glyph_of(char letter) {
    for (const Glyph& glyph : kGlyphs)
        if (glyph.letter == letter) return glyph;
    return kGlyphs.front();
}

constexpr bool has_dot(const Glyph& glyph, int column, int row) {
    const auto at = static_cast<std::size_t>(row * (kGlyphWidth + 1) + column);
    return at < glyph.dots.size() && glyph.dots[at] == '#';
}

}  // namespace raypool
