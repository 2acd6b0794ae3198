/// Calls a fuzz target with every file in the folders named on the command line. Without libFuzzer, so that what a
/// fuzzer once found is part of the ordinary tests.

#include <sys/resource.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/fuzz/fuzz_target.h"

int main(int argument_count, char** arguments) {
#ifdef RAYPOOL_LIMIT_MEMORY  // not where a sanitizer reserves the address space
    const rlimit limit{std::size_t{1} << 30U, std::size_t{1} << 30U};
    if (::setrlimit(RLIMIT_AS, &limit) != 0) return 1;
#endif
    int count = 0;
    for (int i = 1; i < argument_count; ++i) {
        for (const auto& entry : std::filesystem::directory_iterator(arguments[i])) {
            std::ifstream stream(entry.path(), std::ios::binary);
            const std::string content{std::istreambuf_iterator<char>(stream), {}};
            std::fprintf(stderr, "%s\n", entry.path().c_str());  // the last one named is the one that failed
            LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
            ++count;
        }
    }
    std::printf("%d inputs\n", count);
    return count > 0 ? 0 : 1;
}
