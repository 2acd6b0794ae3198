// In place of the codecs of PNG and EXR: files with these names hold PFM here, and all floats of it.
#include "core/image/image_codecs.h"

namespace raypool {

Bytes encode_png(const Image& image, const ImageAttributes&) {
    return encode_pfm(image);
}
ImageContents decode_png(BytesView bytes, std::int64_t max_side, std::int64_t max_pixels) {
    return decode_pfm(bytes, {max_side, max_pixels});
}
Bytes encode_exr(const Image& image, const ImageAttributes&, const ExrExtras&) {
    return encode_pfm(image);
}
ImageContents decode_exr(BytesView bytes, const ImageLimits& limits) {
    return decode_pfm(bytes, limits);
}

}  // namespace raypool
