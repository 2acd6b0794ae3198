#include <memory>
#include <string>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print.h"
#include "core/image_diff.h"
#include "core/image_file.h"
#include "core/output_file.h"
#include "core/tile_bias.h"

namespace raypool::cli {

namespace {

struct DiffOptions {
    std::string a;
    std::string b;
    std::string output;
};

void print_bias(const TileBias& bias) {
    print("tile bias          z = {:.2f} in columns {} to {}, lines {} to {}, where A - B is {:.3g} on average;\n",
          bias.z, bias.x_begin, bias.x_end - 1, bias.y_begin, bias.y_end - 1, bias.difference);
    print("                   {} tile{}, of which chance passes |z| = {:.2f} once in 100 times\n", bias.tile_count,
          bias.tile_count == 1 ? "" : "s", bias.z_limit);
}

int diff(const DiffOptions& options) {
    if (!options.output.empty()) {
        image_format(options.output);
        check_writable(options.output);
    }
    const Image a = read_image(options.a);
    const Image b = read_image(options.b);
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
    print_bias(greatest_tile_bias(a, b));
    if (!options.output.empty()) {
        write_image(options.output, false_colour(a, b), {});
        print("{}\n", options.output);
    }
    return figures.differing_pixels == 0 ? 0 : 1;
}

}  // namespace

void add_diff_command(CLI::App& app, int& status) {
    auto options = std::make_shared<DiffOptions>();
    CLI::App* command = app.add_subcommand("diff", "Compare two images; exit 1 if any bit differs");
    command->add_option("a", options->a, "Image: .png, .exr or .pfm")->required();
    command->add_option("b", options->b, "The reference, of the same size")->required();
    command->add_option("-o,--output", options->output, "Image file for the error in false colour")
        ->check(check_file_name);
    command->callback([options, &status] { status = diff(*options); });
}

}  // namespace raypool::cli
