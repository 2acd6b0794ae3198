/// The headers at the front of an EXR file, looked over before OpenEXR reads pixels by them.
///
/// OpenEXR reads most types of attribute without regard to the size that the file gives, reads on from wherever that
/// leads, and reserves what it finds there as a size. So every attribute must take exactly the size that it is given.
/// The name of a type beyond those is hidden from OpenEXR, which then skips the attribute by its size. And OpenEXR
/// reserves the table of chunks and room for a chunk by what a header claims, so these must be in proportion to the
/// file. Layout: https://openexr.com/en/latest/OpenEXRFileLayout.html Called by exr_codec.cpp.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <vector>

#include "core/image_codecs.h"

namespace raypool {

struct ExrPart {
    Imf::Header header;
    bool is_deep;   ///< any number of values a pixel
    bool is_tiled;  ///< in tiles, otherwise in scan lines
};

struct ExrHeaders {
    std::vector<ExrPart> parts;       ///< one, if the file is not of several
    std::vector<std::size_t> hidden;  ///< places in the file that OpenEXR must not see as they are: see MemoryInput
};

/// Throws std::runtime_error where a header is unsound, or claims
/// more than kMaxImageSide, than kMaxImagePixels, or than a file of this size can hold.
ExrHeaders read_exr_headers(BytesView bytes);

/// Rows that the part's codec takes together.
std::int64_t rows_per_chunk(const Imf::Header& header);

}  // namespace raypool
