// make_scenes SOURCE TARGET: what the tests for ARM read, with the pixels of every image as PFM, whatever its name
// says.

#include <cstdio>
#include <exception>
#include <filesystem>

#include "core/base/output_file.h"
#include "core/image/image_codecs.h"

namespace fs = std::filesystem;

int main(int argc, char** argv) try {
    if (argc != 3) throw std::runtime_error("usage: make_scenes SOURCE TARGET");
    const fs::path source = argv[1];
    const fs::path target = argv[2];
    for (const char* folder : {"scenes", "tests/equivalence"}) {
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source / folder)) {
            const fs::path copy = target / fs::relative(entry.path(), source);
            const fs::path kind = entry.path().extension();
            fs::create_directories(copy.parent_path());
            if (kind == ".png" || kind == ".exr") {
                raypool::write_whole(copy, raypool::encode_pfm(raypool::read_image(entry.path())));
            } else if (kind == ".json" || kind == ".obj") {
                fs::copy_file(entry.path(), copy, fs::copy_options::overwrite_existing);
            }
        }
    }
} catch (const std::exception& error) {
    std::fprintf(stderr, "make_scenes: %s\n", error.what());
    return 1;
}
