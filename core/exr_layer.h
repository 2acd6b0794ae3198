/// Which channels of an EXR file are its picture.
///
/// R, G and B, or the luminance Y alone or with the chroma RY and BY, of the first part that has them; without a
/// layer's name before them or, where only one layer has them, with it ("beauty.R").
/// Called by exr_codec.cpp.
#pragma once

#include <string>
#include <vector>

#include "core/exr_header.h"

namespace raypool {

struct ExrLayer {
    enum class Kind { Colour, Luminance, LuminanceAndChroma };
    std::size_t part;
    Kind kind;
    std::string layer;  ///< without the dot after it; may be empty

    [[nodiscard]] std::string channel(const char* name) const { return layer.empty() ? name : layer + '.' + name; }
    /// Those that are read.
    [[nodiscard]] std::vector<std::string> channels() const;
};

/// Throws std::runtime_error, with the choice there was, where it is not clear or there is none.
ExrLayer exr_layer(const std::vector<ExrPart>& parts);

/// The channels of all parts but those of `layer`; those of another part with its name and a colon before them.
std::vector<std::string> other_channels(const std::vector<ExrPart>& parts, const ExrLayer& layer);

}  // namespace raypool
