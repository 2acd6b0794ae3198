/// Which settings a test tries where there are too many for a build of debugging, in which sanitizers are slow.
#pragma once

#include <cstddef>

namespace raypool {

/// Takes every entry of a release build and every n-th of a build of debugging, from the first on. An n that divides no
/// dimension of the matrix meets every value of each.
class EveryNth {
  public:
    explicit EveryNth(std::size_t n) : n_(n) {}
    bool takes_next() {
#ifdef NDEBUG
        return true;
#else
        return count_++ % n_ == 0;
#endif
    }

  private:
    [[maybe_unused]] std::size_t n_;
    [[maybe_unused]] std::size_t count_ = 0;
};

}  // namespace raypool
