/// The device that is a GPU of NVIDIA's.
#pragma once

#include <memory>

#include "gpu/device.h"

namespace raypool::gpu {

/// Of several on a machine each of a job's ranks on it takes the next. Throws InputError where there is no driver or no
/// device, and std::runtime_error for what the driver says.
std::unique_ptr<Device> cuda_device();

/// Whether there is one.
bool has_cuda_device();

}  // namespace raypool::gpu
