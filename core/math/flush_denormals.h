/// Denormal numbers as zero: the processor's flag for it.
#pragma once

#include <immintrin.h>

namespace raypool {

/// Makes the calling thread treat denormal numbers as zero while it lives; engines hold one in every thread. A path
/// whose throughput fades would otherwise cost hundreds of times more for light that cannot be seen.
class FlushDenormals {
  public:
    FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero); }
    ~FlushDenormals() { _mm_setcsr(before_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    static constexpr unsigned kFlushToZero = 0x8000;
    static constexpr unsigned kDenormalsAreZero = 0x0040;
    unsigned before_;
};

}  // namespace raypool
