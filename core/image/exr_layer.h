/// Which channels of an EXR file make the pixels of its image, and what the file holds beside them.
#pragma once

#include <OpenEXR/ImfMultiPartInputFile.h>

#include <array>
#include <string>
#include <vector>

namespace raypool {

/// The channels that make a pixel.
struct ExrLayer {
    int part = -1;
    std::array<std::string, 3> channels;  ///< of red, green and blue; the same of a grey image
    bool has_chroma = false;              ///< luminance, beside which there is chroma
};

/// The first layer with red, green and blue, one without a name before others; else the first luminance. Throws
/// std::runtime_error where there is neither.
ExrLayer find_layer(const Imf::MultiPartInputFile& file);

/// What the file holds beside the layer.
std::vector<std::string> left_out(const Imf::MultiPartInputFile& file, const ExrLayer& layer);

}  // namespace raypool
