/// What a test does with two images that should be one: compare hashes, and where they differ leave both and their
/// difference behind, in the folder "failed" of the build's tests, to be looked at.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "core/image/image_diff.h"
#include "core/image/image_file.h"
#include "tests/small_render.h"

namespace raypool {

/// Writes NAME.exr, NAME.expected.exr and NAME.difference.png (false colour), and says how far they are apart.
inline std::string leave_difference(const std::string& name, const Image& expected, const Image& got) {
    const std::filesystem::path folder = RAYPOOL_FAILURE_FOLDER;
    std::filesystem::create_directories(folder);
    const std::string stem = (folder / name).string();
    write_image(stem + ".exr", got, {});
    write_image(stem + ".expected.exr", expected, {});
    write_image(stem + ".difference.png", false_colour(got, expected), {});
    const ImageDiff diff = compare_images(got, expected);
    return fmt::format("{} of {} pixels differ, RMSE {:.3g}, largest difference {:.3g}; see {}.difference.png",
                       diff.differing_pixels, got.width * got.height, diff.rmse, diff.max_abs, stem);
}

/// `name` becomes part of file names; `how` says how `got` was made.
inline testing::AssertionResult same_image(const std::string& name, const Rendered& expected, const Rendered& got,
                                           const std::string& how) {
    if (got.hash() == expected.hash()) return testing::AssertionSuccess();
    return testing::AssertionFailure() << how << ": hash " << got.hash() << " in place of " << expected.hash() << "; "
                                       << leave_difference(name, expected.image(), got.image());
}

}  // namespace raypool
