#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print.h"
#include "core/base/error.h"
#include "core/base/output_file.h"
#include "core/image/image_diff.h"
#include "core/image/image_file.h"
#include "core/image/tile_bias.h"
#include "core/runtime/settings_text.h"

namespace raypool::cli {

namespace {

/// What --tolerance may be given for, and how much of it there is.
struct Measure {
    const char* name;
    double (*value)(const ImageDiff& figures);
};
constexpr Measure kMeasures[] = {
    {"mse", [](const ImageDiff& figures) { return figures.mse; }},
    {"rmse", [](const ImageDiff& figures) { return figures.rmse; }},
    {"relmse", [](const ImageDiff& figures) { return figures.rel_mse; }},
    {"largest", [](const ImageDiff& figures) { return figures.max_abs; }},
    {"ulp", [](const ImageDiff& figures) { return static_cast<double>(figures.max_ulp); }},
    {"pixels", [](const ImageDiff& figures) { return static_cast<double>(figures.differing_pixels); }},
};

/// The most of a measure that still counts as equal.
struct Tolerance {
    Measure measure;
    double most;
};

Tolerance parse_tolerance(const std::string& text) {
    const std::size_t equals = text.find('=');
    const auto* const measure = std::find_if(std::begin(kMeasures), std::end(kMeasures),
                                             [&](const Measure& m) { return text.substr(0, equals) == m.name; });
    double most = 0;
    const char* const end = text.data() + text.size();
    const char* const number = equals == std::string::npos ? end : text.data() + equals + 1;
    const auto [stop, error] = std::from_chars(number, end, most);
    if (measure == std::end(kMeasures) || error != std::errc() || stop != end || !(most >= 0) || std::isinf(most)) {
        throw InputError(fmt::format(
            "--tolerance: must be MEASURE=X with X >= 0 and mse, rmse, relmse, largest, ulp or pixels, got {}", text));
    }
    return {*measure, most};
}

struct DiffOptions {
    std::string a;
    std::string b;
    std::string output;
    std::vector<std::string> tolerances;
};

/// Samples a pixel that an image was made of, where it says so; not of an adaptive render, which has no one number.
std::optional<std::int64_t> samples_of(const ImageAttributes& attributes) {
    const auto done = attributes.find("raypool.samples_done");
    const auto spp = done != attributes.end() ? done : attributes.find("raypool.spp");
    if (spp == attributes.end() || attributes.count("raypool.target_error") > 0) return {};
    return parse_integer(spp->second, 1, std::numeric_limits<std::int64_t>::max());
}

SampleCounts compare_counts(const std::optional<std::int64_t>& a, const std::optional<std::int64_t>& b) {
    if (!a || !b) return SampleCounts::Unknown;
    return *a == *b ? SampleCounts::Equal : *a < *b ? SampleCounts::FirstHasFewer : SampleCounts::SecondHasFewer;
}

std::string verdict_text(const TileBias& bias, const std::optional<std::int64_t>& a,
                         const std::optional<std::int64_t>& b) {
    switch (bias_verdict(bias, compare_counts(a, b))) {
        case BiasVerdict::Chance:
            return "what noise makes";
        case BiasVerdict::Bias:
            return "a bias";
        case BiasVerdict::BiasIfEqual:
            return "a bias if both have as many samples a pixel, which these files do not say";
        case BiasVerdict::RareLight:
            break;
    }
    return fmt::format("no verdict: of {} and {} samples a pixel, the fewer may not have met light that is rare", *a,
                       *b);
}

void print_bias(const std::optional<TileBias>& bias, const std::optional<std::int64_t>& samples_a,
                const std::optional<std::int64_t>& samples_b) {
    if (!bias) {
        print("tile bias          none: no tile has two pixels that are finite in A and B and that differ\n");
        return;
    }
    print("tile bias          t = {:.2f} over {} pixels in columns {} to {}, lines {} to {}, where A - B is {:.3g}\n",
          bias->t, bias->pixel_count, bias->x_begin, bias->x_end - 1, bias->y_begin, bias->y_end - 1, bias->difference);
    print("                   chance makes the greatest of {} tile{} so different in {:.2g} of images: {}\n",
          bias->tile_count, bias->tile_count == 1 ? "" : "s", bias->image_p_value,
          verdict_text(*bias, samples_a, samples_b));
}

/// The display window: black where the file has no pixel.
Image shown(ImageContents contents) {
    const PixelWindow& data = contents.data_window;
    const PixelWindow& display = contents.display_window;
    if (data == display) return std::move(contents.image);
    Image image(display.x_end - display.x_begin, display.y_end - display.y_begin);
    const std::int64_t x_begin = std::max(data.x_begin, display.x_begin);
    const std::int64_t x_end = std::min(data.x_end, display.x_end);
    for (std::int64_t y = std::max(data.y_begin, display.y_begin); y < std::min(data.y_end, display.y_end); ++y) {
        if (x_begin >= x_end) break;
        const float* const from = contents.image.pixel(x_begin - data.x_begin, y - data.y_begin);
        std::copy(from, from + 3 * (x_end - x_begin), image.pixel(x_begin - display.x_begin, y - display.y_begin));
    }
    return image;
}

/// What of two files is not in the comparison.
std::vector<std::string> not_compared(const ImageContents& a, const ImageContents& b) {
    std::vector<std::string> list;
    for (const auto& [name, contents] : {std::pair<const char*, const ImageContents&>{"A", a}, {"B", b}}) {
        for (const std::string& what : contents.left_out) list.push_back(fmt::format("{} of {}", what, name));
        const PixelWindow& data = contents.data_window;
        const PixelWindow& display = contents.display_window;
        if (data.x_begin < display.x_begin || data.x_end > display.x_end || data.y_begin < display.y_begin ||
            data.y_end > display.y_end)
            list.push_back(fmt::format("pixels of {} outside of its display window", name));
    }
    if (a.primaries != b.primaries)
        list.push_back(fmt::format("primaries: those of A are {}, of B {}", a.primaries, b.primaries));
    return list;
}

int diff(const DiffOptions& options) {
    std::vector<Tolerance> tolerances;
    for (const std::string& text : options.tolerances) tolerances.push_back(parse_tolerance(text));
    check_distinct({{"--output", options.output}}, {{"A", options.a}, {"B", options.b}});
    if (!options.output.empty()) {
        image_format(options.output);
        check_writable(options.output);
    }
    ImageContents contents_a = read_image_contents(options.a);
    ImageContents contents_b = read_image_contents(options.b);
    const std::vector<std::string> missing = not_compared(contents_a, contents_b);
    const std::optional<std::int64_t> samples_a = samples_of(contents_a.attributes);
    const std::optional<std::int64_t> samples_b = samples_of(contents_b.attributes);
    const Image a = shown(std::move(contents_a));
    const Image b = shown(std::move(contents_b));
    const ImageDiff figures = compare_images(a, b);
    print("pixels that differ {} of {}\n", figures.differing_pixels, a.width * a.height);
    print("MSE                {:.6g}\n", figures.mse);
    print("RMSE               {:.6g}\n", figures.rmse);
    print("relMSE             {:.6g}\n", figures.rel_mse);
    print("PSNR               {:.2f} dB\n", figures.psnr);
    print("largest difference {:.6g}\n", figures.max_abs);
    print("largest ULP        {}\n", figures.max_ulp);
    print("mean of A          {:.8g} {:.8g} {:.8g}\n", figures.mean_a[0], figures.mean_a[1], figures.mean_a[2]);
    print("mean of B          {:.8g} {:.8g} {:.8g}\n", figures.mean_b[0], figures.mean_b[1], figures.mean_b[2]);
    print_bias(greatest_tile_bias(a, b), samples_a, samples_b);
    for (const std::string& what : missing) print("not compared       {}\n", what);
    if (!options.output.empty()) {
        write_image(options.output, false_colour(a, b), {});
        print("{}\n", options.output);
    }
    if (tolerances.empty()) tolerances.push_back(parse_tolerance("pixels=0"));
    bool is_within = missing.empty();
    for (const Tolerance& tolerance : tolerances) {
        const double value = tolerance.measure.value(figures);
        if (value <= tolerance.most) continue;
        is_within = false;
        if (!options.tolerances.empty())
            print("beyond tolerance   {} is {:.6g}, more than {:.6g}\n", tolerance.measure.name, value, tolerance.most);
    }
    return is_within ? 0 : 1;
}

}  // namespace

void add_diff_command(CLI::App& app, int& status) {
    auto options = std::make_shared<DiffOptions>();
    CLI::App* command = app.add_subcommand(
        "diff",
        "Compare two images; exit 1 if any bit differs, or more than --tolerance, or if not all of a file is compared");
    command->add_option("a", options->a, "Image: .png, .exr or .pfm")->required();
    command->add_option("b", options->b, "The reference, of the same size")->required();
    command
        ->add_option(
            "--tolerance", options->tolerances,
            "MEASURE=X: exit 0 if no more than X of mse, rmse, relmse, largest (difference), ulp or pixels (that "
            "differ); may be repeated (default: pixels=0)")
        ->take_all();
    command->add_option("-o,--output", options->output, "Image file for the error in false colour")
        ->check(check_file_name);
    command->callback([options, &status] { status = diff(*options); });
}

}  // namespace raypool::cli
