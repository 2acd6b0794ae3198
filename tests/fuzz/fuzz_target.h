/// What the fuzz targets share. A target is a file that defines LLVMFuzzerTestOneInput: libFuzzer calls it with inputs
/// of its own making (scripts/fuzz), replay.cpp with the committed ones (the ordinary tests).
///
/// A finding is whatever ends the process: a sanitizer's report, an exception of another type than the reader promises,
/// a require() that fails, too much memory, too much time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace raypool {

inline void require(bool is_true, const char* rule) {
    if (is_true) return;
    std::fprintf(stderr, "finding: must hold: %s\n", rule);
    std::abort();
}

/// A message repeats what it found in the file, and goes to a user's terminal.
inline void require_one_line(std::string_view message) {
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    require(!message.empty() && std::none_of(message.begin(), message.end(), is_control), "one printable line");
}

}  // namespace raypool
