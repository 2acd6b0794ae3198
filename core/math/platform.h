/// What a compiler must be told about a function or a constant: kernels, and all that they call, are compiled for the
/// host, and by nvcc for a GPU as well.
#pragma once

#ifdef __CUDACC__
#define RAYPOOL_HOST_DEVICE __host__ __device__
/// A constant whose address is taken, such as a table or an object that is called.
#define RAYPOOL_CONSTANT static constexpr __device__
/// Before a loop whose constants must be computed by the compiler; those of the host do it without being told.
#define RAYPOOL_UNROLL _Pragma("unroll")
#else
#define RAYPOOL_HOST_DEVICE
#define RAYPOOL_CONSTANT inline constexpr
#define RAYPOOL_UNROLL
#endif

/// A function that is always a part of its caller: what takes or returns a register must be, to be fast. Sanitizers
/// check every access of the whole that comes of it, which takes a compiler ten times as long.
#ifdef RAYPOOL_SANITIZED
#define RAYPOOL_INLINE RAYPOOL_HOST_DEVICE inline
#else
#define RAYPOOL_INLINE [[gnu::always_inline]] RAYPOOL_HOST_DEVICE inline
#endif
