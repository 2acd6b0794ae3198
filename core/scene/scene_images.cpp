#include "core/scene/scene_images.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool {

namespace fs = std::filesystem;

fs::path SceneImages::path(const JsonCursor& place) const {
    const fs::path relative = place.text();
    const bool goes_up = std::find(relative.begin(), relative.end(), "..") != relative.end();
    if (relative.is_absolute() || goes_up) place.refuse("be a path below the scene's folder, without \"..\"");

    std::error_code error;
    const fs::path root = fs::weakly_canonical(folder_.empty() ? "." : folder_, error);
    const fs::path file = error ? fs::path() : fs::weakly_canonical(root / relative, error);
    if (error) place.refuse("name a file", error.message());
    const auto root_end = std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first;
    if (root_end != root.end()) {
        place.refuse("stay below the scene's folder", "a link to " + file.string());
    }
    return folder_ / relative;
}

Image SceneImages::read(const JsonCursor& place, Read read_file, const char* what) {
    const fs::path file = path(place);
    try {
        Image image = read_file(file, texels_left_);
        texels_left_ -= image.width * image.height;
        return image;
    } catch (const InputError& broken) {
        place.refuse(fmt::format("name {} image that can be read", what), broken.what());
    }
}

std::shared_ptr<const Image> SceneImages::texture(const JsonCursor& place) {
    return std::make_shared<const Image>(read(place, read_texture, "a PNG"));
}

std::shared_ptr<const Image> SceneImages::environment(const JsonCursor& place) {
    Image image = read(place, read_environment, "an EXR or PFM");
    if (image.width != 2 * image.height)
        place.refuse("name an image twice as wide as high",
                     fmt::format("{} of {} x {}", place.text(), image.width, image.height));
    const auto bad = std::find_if(image.rgb.begin(), image.rgb.end(), [](float value) {
        return !(value >= 0 && value <= std::numeric_limits<float>::max());
    });
    if (bad != image.rgb.end()) {
        const std::int64_t pixel = (bad - image.rgb.begin()) / 3;
        place.refuse("name an image whose values are finite and not negative",
                     fmt::format("{} with {:g} in column {} of row {}", place.text(), *bad, pixel % image.width,
                                 pixel / image.width));
    }
    return std::make_shared<const Image>(std::move(image));
}

}  // namespace raypool
