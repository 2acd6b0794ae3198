/// A cost image as a picture: false colours, and a scale with numbers and the unit beside it.
#pragma once

#include "core/image/cost_image.h"
#include "core/image/image.h"

namespace raypool {

/// The scale begins at 0 and ends at the first tick from the 99.5th percentile on, so that a few dear pixels do not
/// darken the rest; where pixels lie above it, the last tick says so by a "greater or equal" sign. Each pixel becomes a
/// square, large enough for the scale to be readable beside a small image.
Image heat_map(const CostImage& cost);

}  // namespace raypool
