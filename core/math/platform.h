/// What a compiler must be told about a function.
#pragma once

/// Kernels, and all that they call: for the host, and under nvcc for the device as well.
#ifdef __CUDACC__
#define RAYPOOL_HOST_DEVICE __host__ __device__
#else
#define RAYPOOL_HOST_DEVICE
#endif

/// The same, and always a part of its caller: for what takes or returns a register.
#define RAYPOOL_INLINE [[gnu::always_inline]] RAYPOOL_HOST_DEVICE inline
