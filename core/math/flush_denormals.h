/// Denormal numbers as zero: the processor's mode for it.
#pragma once

#include <cstdint>

#include "core/math/processor.h"

namespace raypool {

/// Makes the calling thread treat denormal numbers as zero while it lives; engines hold one in every thread. A path
/// whose throughput fades would otherwise cost hundreds of times more for light that cannot be seen.
class FlushDenormals {
  public:
    FlushDenormals() : before_(floating_point_modes()) { set_floating_point_modes(before_ | kFlushDenormals); }
    ~FlushDenormals() { set_floating_point_modes(before_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    std::uint64_t before_;
};

}  // namespace raypool
