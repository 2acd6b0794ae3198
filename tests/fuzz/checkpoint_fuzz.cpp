/// Any bytes as a checkpoint or a part, with the checksum they have and with the right one: they are refused by an
/// InputError, or do what `merge` and `--resume` do with them.

#include <string>
#include <string_view>

#include <fmt/format.h>
#include <xxhash.h>

#include "core/base/error.h"
#include "core/film/checkpoint.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace raypool;

void try_reader(std::string_view content) {
    try {
        const Checkpoint sums = decode_checkpoint(content, "fuzz.sums");
        require_one_line("of a render with " + difference(sums.key, {}));
        require(sums.sample_count() >= 0, "a count of samples is not negative");
        gaps(sums.ranges, sums.spp);
        const Image image = sums.framebuffer.image(sums.sample_count());
        require(std::ssize(image.rgb) == std::ssize(sums.framebuffer.sums()), "an image has all pixels");
        require(sums.framebuffer.hash().size() == 16, "a hash has 16 digits");
    } catch (const InputError& refusal) {
        require_one_line(refusal.what());
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view content(reinterpret_cast<const char*>(data), size);
    try_reader(content);
    try_reader(std::string(content) + fmt::format("{:016x}", XXH3_64bits(content.data(), content.size())));
    return 0;
}
