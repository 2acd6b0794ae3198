/// The files that a scene names: textures, the image around it, and meshes. Called by scene_parser.cpp alone.
#pragma once

#include <filesystem>
#include <memory>

#include "core/image/image_file.h"
#include "core/scene/json_cursor.h"

namespace raypool {

/// Reads images below the scene's folder, wherever links lead: a scene from elsewhere opens nothing else. Together they
/// hold at most kMaxSceneTexels: a small file can be a large image. What is refused is refused at the place that names
/// the file.
class SceneImages {
  public:
    explicit SceneImages(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// A PNG file.
    std::shared_ptr<const Image> texture(const JsonCursor& place);
    /// An EXR or PFM file, twice as wide as high, of values that are finite and not negative.
    std::shared_ptr<const Image> environment(const JsonCursor& place);

    /// Where a file lies that the scene names.
    [[nodiscard]] std::filesystem::path path(const JsonCursor& place) const;

  private:
    using Read = Image (*)(const std::filesystem::path&, std::int64_t max_texels);
    Image read(const JsonCursor& place, Read read_file, const char* what);

    std::filesystem::path folder_;
    std::int64_t texels_left_ = kMaxSceneTexels;
};

}  // namespace raypool
