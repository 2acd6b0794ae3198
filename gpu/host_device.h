/// A device that is the host: its threads run the kernels' bodies. What it makes is what a GPU makes, but for the
/// compiler, the driver and the chip.
#pragma once

#include <memory>

#include "gpu/device.h"

namespace raypool::gpu {

/// Kernels run on `threads` threads of OpenMP.
std::unique_ptr<Device> host_device(int threads);

}  // namespace raypool::gpu
