/// The colour map of pictures that show figures: perceptually uniform, told apart by the colour-blind and in grey.
#pragma once

namespace raypool {

/// Writes the linear RGB of "inferno" at `position`, clamped to [0, 1]: black, violet, orange, pale yellow.
void inferno(double position, float* rgb);

}  // namespace raypool
