/// Options that commands share, and how their texts are read. A text that makes no sense is an InputError naming the
/// option.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/film/checkpoint.h"
#include "core/image/image.h"
#include "core/image/image_file.h"
#include "core/runtime/settings_text.h"

namespace raypool::cli {

enum class Precision : std::uint8_t { Float, Double };

/// A sample has a number that fits into 31 bits.
inline constexpr std::int64_t kMostSpp = std::numeric_limits<std::int32_t>::max();

/// "A:B" with 0 <= A < B <= spp.
SampleRange parse_samples(std::string_view text, std::int64_t spp);

/// "X0,Y0,X1,Y1": columns X0 to X1 and rows Y0 to Y1, without the last ones, of an image of this size; or the one pixel
/// "X,Y". `option` is named in refusals.
PixelWindow parse_window(std::string_view text, const char* option, std::int64_t width, std::int64_t height);
PixelWindow parse_pixel(std::string_view text, const char* option, std::int64_t width, std::int64_t height);

/// Of an image that is so wide, as RenderSettings::pixels has them: in rising order.
std::vector<std::uint32_t> pixels_of(const PixelWindow& window, std::int64_t width);

/// A whole number below 2^64.
std::uint64_t parse_seed(std::string_view text);

/// Threads as asked for with --threads, or OMP_NUM_THREADS where `asked` is 0. Refuses more than OpenMP and the system
/// would give (core/base/thread_limit.h). What follows in this thread, such as building trees, uses as many.
int thread_count(int asked);

/// Where an image goes: a file, whose name says how it is written, or "png:-", "exr:-" or "pfm:-" for the standard
/// output.
struct ImageTarget {
    std::string file;
    ImageFormat format;
    bool is_stdout;
};
ImageTarget parse_image_target(const std::string& text);

using NamedFiles = std::vector<std::pair<std::string, std::string>>;

/// Refuses two outputs that are one file, by whatever names and links, and an output that would write over an input.
/// Both are pairs of an option and its file; empty names are none.
void check_distinct(const NamedFiles& outputs, const NamedFiles& inputs = {});

/// Refuses what is no number within [least, most]; NaN is none. For CLI::Option::check().
std::function<std::string(const std::string&)> check_within(double least, double most);

/// Refuses an empty text, which a shell makes of a variable that is not set. For CLI::Option::check().
std::string check_file_name(const std::string& text);

}  // namespace raypool::cli
