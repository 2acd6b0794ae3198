/// What can go wrong through no fault of the program.
///
/// InputError is thrown by everything that reads what a user wrote (scenes, images, flags). Its text is one line that
/// names the file and the place in it: `scenes/a.json: /materials/3/albedo: must be within [0, 1], got 1.7`. Code that
/// knows the place better catches it, adds the place and throws again. The command's main reports it: exit 2, nothing
/// written.
/// A broken promise inside the program is a bug: RAYPOOL_CHECK prints where and what, and stops the process.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace raypool {

class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace raypool

/// Stops with the place and `message` (a string literal saying which promise was broken) when `condition` is false.
#define RAYPOOL_CHECK(condition, message)                                                                      \
    do {                                                                                                       \
        if (!(condition)) [[unlikely]] {                                                                       \
            std::fprintf(stderr, "raypool: bug at %s:%d: %s (%s)\n", __FILE__, __LINE__, message, #condition); \
            std::abort();                                                                                      \
        }                                                                                                      \
    } while (false)
