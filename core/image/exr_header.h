/// The attributes at the front of an EXR file, looked over before OpenEXR reads them.
///
/// OpenEXR reads most types of attribute without regard to the size that the file gives, reads on from wherever that
/// leads, and reserves what it finds there as a size. So every attribute must take exactly the size that it is given.
/// Layout: https://openexr.com/en/latest/OpenEXRFileLayout.html
/// Called by exr_codec.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/image/image_codecs.h"

namespace raypool {

inline constexpr std::int32_t kExrMagic = 20000630;

struct ExrHeader {
    std::int32_t version;                      ///< with its flags
    std::vector<std::int64_t> channel_counts;  ///< of each part
    std::vector<std::size_t> hidden;           ///< places in the file that OpenEXR must not see as they are
};

/// Throws std::runtime_error for what is not an EXR file with sound attributes. An attribute of a type that this reader
/// does not know takes what it says. The first letter of such a type is to be hidden: OpenEXR then passes over the
/// attribute by its size, whereas of a type that only some versions know (idmanifest) they take more or less.
ExrHeader check_exr_header(BytesView bytes);

}  // namespace raypool
