/// Any bytes as an image of each format: they are refused by an exception, or make an image of the size that it says.

#include <zlib.h>

#include <cstring>
#include <exception>
#include <new>

#include "core/image/image_codecs.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace raypool;

template <class Decode>
void try_decoder(Decode decode) {
    try {
        decode();
    } catch (const std::bad_alloc&) {
        throw;  // memory for what a file only claims to hold
    } catch (const std::logic_error&) {
        throw;  // a rule of our own is broken
    } catch (const std::exception&) {
    }
}

void check_image(const Image& image) {
    require(image.width > 0 && image.height > 0 && std::ssize(image.rgb) == image.width * image.height * 3,
            "an image has three values for each of its pixels");
}

/// A PNG file with the checksum of each chunk made right, so that what lies behind the checksums is tried too.
Bytes with_right_checksums(BytesView bytes) {
    constexpr std::size_t kSignature = 8, kFrame = 12;
    Bytes fixed(bytes.begin(), bytes.end());
    for (std::size_t at = kSignature; at + kFrame <= fixed.size();) {
        const auto* chunk = reinterpret_cast<const Bytef*>(fixed.data()) + at;
        const std::size_t length = std::size_t{chunk[0]} << 24 | chunk[1] << 16 | chunk[2] << 8 | chunk[3];
        if (length > fixed.size() - at - kFrame) break;
        const std::uint32_t sum =
            __builtin_bswap32(static_cast<std::uint32_t>(crc32(0, chunk + 4, static_cast<uInt>(length + 4))));
        std::memcpy(fixed.data() + at + 8 + length, &sum, sizeof sum);
        at += kFrame + length;
    }
    return fixed;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const BytesView bytes(reinterpret_cast<const std::byte*>(data), size);
    try_decoder([&] { check_image(decode_png(bytes, kMaxTextureSide, kMaxSceneTexels).image); });
    try_decoder([&] { check_image(decode_png(with_right_checksums(bytes), kMaxTextureSide, kMaxSceneTexels).image); });
    try_decoder([&] { check_image(decode_pfm(bytes).image); });
    try_decoder([&] { check_image(decode_exr(bytes).image); });
    return 0;
}
