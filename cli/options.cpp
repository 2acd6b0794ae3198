#include "cli/options.h"

#include <omp.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/output_file.h"
#include "core/base/thread_limit.h"

namespace raypool::cli {

SampleRange parse_samples(std::string_view text, std::int64_t spp) {
    const std::size_t colon = text.find(':');
    if (colon != std::string_view::npos) {
        const auto first = parse_integer(text.substr(0, colon), 0, spp - 1);
        const auto end = parse_integer(text.substr(colon + 1), 1, spp);
        if (first && end && *first < *end) return {*first, *end};
    }
    throw InputError(fmt::format("--samples: must be A:B with 0 <= A < B <= spp ({}), got {}", spp, text));
}

namespace {

/// Whole numbers with commas between, as many as `most` has, each at most as much; nothing where it is not that.
template <std::size_t count>
std::optional<std::array<std::int64_t, count>> parse_numbers(std::string_view text,
                                                             const std::array<std::int64_t, count>& most) {
    std::array<std::int64_t, count> numbers;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t comma = i + 1 < count ? text.find(',') : text.size();
        const auto number = parse_integer(text.substr(0, comma), 0, most[i]);
        if (comma == std::string_view::npos || !number) return std::nullopt;
        numbers[i] = *number;
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return numbers;
}

}  // namespace

PixelWindow parse_window(std::string_view text, const char* option, std::int64_t width, std::int64_t height) {
    const auto numbers = parse_numbers<4>(text, {width, height, width, height});
    if (numbers) {
        const auto [x_begin, y_begin, x_end, y_end] = *numbers;
        if (x_begin < x_end && y_begin < y_end) return {x_begin, x_end, y_begin, y_end};
    }
    throw InputError(fmt::format("{}: must be X0,Y0,X1,Y1 with 0 <= X0 < X1 <= {} and 0 <= Y0 < Y1 <= {}, got {}",
                                 option, width, height, text));
}

PixelWindow parse_pixel(std::string_view text, const char* option, std::int64_t width, std::int64_t height) {
    const auto numbers = parse_numbers<2>(text, {width - 1, height - 1});
    if (!numbers)
        throw InputError(
            fmt::format("{}: must be X,Y with 0 <= X < {} and 0 <= Y < {}, got {}", option, width, height, text));
    const auto [x, y] = *numbers;
    return {x, x + 1, y, y + 1};
}

std::vector<std::uint32_t> pixels_of(const PixelWindow& window, std::int64_t width) {
    std::vector<std::uint32_t> pixels;
    for (std::int64_t y = window.y_begin; y < window.y_end; ++y)
        for (std::int64_t x = window.x_begin; x < window.x_end; ++x)
            pixels.push_back(static_cast<std::uint32_t>(y * width + x));
    return pixels;
}

std::uint64_t parse_seed(std::string_view text) {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
    if (error != std::errc() || end != text.data() + text.size())
        throw InputError(fmt::format("--seed: must be a whole number in [0, 2^64), got {}", text));
    return seed;
}

int thread_count(int asked) {
    const int count = asked == 0 ? omp_get_max_threads() : asked;
    check_thread_count(count, asked == 0 ? "OMP_NUM_THREADS" : "--threads");
    omp_set_num_threads(count);
    return count;
}

ImageTarget parse_image_target(const std::string& text) {
    if (text.ends_with(":-")) return {"/dev/stdout", image_format("image." + text.substr(0, text.size() - 2)), true};
    return {text, image_format(text), false};
}

namespace {

/// What is the same for all names of a file that is there or could be; empty for a device, and for what is refused
/// elsewhere.
std::string identity(const std::string& name) {
    struct stat status {};
    if (::stat(name.c_str(), &status) == 0)
        return S_ISREG(status.st_mode) ? fmt::format("{} {}", status.st_dev, status.st_ino) : "";
    std::error_code error;
    const std::filesystem::path path = weakly_canonical(absolute(final_file(name), error), error);
    return error ? "" : path.string();
}

}  // namespace

void check_distinct(const NamedFiles& outputs, const NamedFiles& inputs) {
    std::map<std::string, std::string> option_of;
    for (const auto& [option, file] : inputs)
        if (std::error_code error; std::filesystem::exists(file, error)) option_of.emplace(identity(file), option);
    for (const auto& [option, file] : outputs) {
        const std::string id = file.empty() ? "" : identity(file);
        if (id.empty()) continue;
        const auto [other, is_new] = option_of.emplace(id, option);
        if (!is_new) throw InputError(fmt::format("{}: {} is also the file of {}", option, file, other->second));
    }
}

std::function<std::string(const std::string&)> check_within(double least, double most) {
    return [least, most](const std::string& text) {
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool is_number = error == std::errc() && end == text.data() + text.size();
        if (is_number && value >= least && value <= most) return std::string();
        return fmt::format("must be a number in [{:g}, {:g}], got {}", least, most, text);
    };
}

std::string check_file_name(const std::string& text) {
    return text.empty() ? "must name a file" : "";
}

}  // namespace raypool::cli
