# Every compiler flag that an image or a figure depends on, in one place. All targets link raypool::flags.
#
# -ffp-contract=off    a fused multiply-add happens only where the source says so: one image on every machine
# -fno-math-errno      sqrt is one instruction
# --param=large-function-insns
#                      No function is large. A stage is one function of tens of thousands of calls to what
#                      <experimental/simd> is made of. gcc stops inlining these early in a function that is large, and later
#                      weighs each against all others: half of the time to compile it, for slower code (CONTRIBUTING.md).
# Not here, ever: -ffast-math and its parts. They change images (docs/architecture.md, "One image").

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

set(RAYPOOL_ARCH "native" CACHE STRING "Instruction set: the value of -march=, or on ARM of -mcpu=")
set(RAYPOOL_SANITIZE "" CACHE STRING "Sanitizers: the value of -fsanitize=, empty for none")
option(RAYPOOL_FUZZ "Link the fuzz targets with libFuzzer; asks for clang++ and address in RAYPOOL_SANITIZE" OFF)
option(RAYPOOL_WERROR "Treat warnings as errors" OFF)

if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
  string(REPLACE x86-64-v3 generic cpu ${RAYPOOL_ARCH})  # of the preset portable
  set(RAYPOOL_ARCH_FLAG -mcpu=${cpu})
else()
  set(RAYPOOL_ARCH_FLAG -march=${RAYPOOL_ARCH})
endif()

add_library(raypool_flags INTERFACE)
add_library(raypool::flags ALIAS raypool_flags)
set_target_properties(raypool_flags PROPERTIES EXPORT_NAME flags)
target_compile_features(raypool_flags INTERFACE cxx_std_20)
target_compile_options(raypool_flags INTERFACE
  ${RAYPOOL_ARCH_FLAG} -ffp-contract=off -fno-math-errno)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(raypool_flags INTERFACE --param=large-function-insns=1000000000)
endif()
target_compile_definitions(raypool_flags INTERFACE EIGEN_DONT_PARALLELIZE EIGEN_DONT_VECTORIZE)

# For what is no kernel, such as commands and most tests: two thirds of the time to compile. It changes no value.
add_library(raypool_not_hot INTERFACE)
target_compile_options(raypool_not_hot INTERFACE $<$<CONFIG:Release>:-O1>)

add_library(raypool_warnings INTERFACE)
# gcc 12 finds "uninitialised" values inside its own AVX-512 header (its bug 105593), and tells on ARM that gcc 9 passed
# registers otherwise. Where it collects its garbage earlier, it takes a fifth less memory and a twentieth more time.
target_compile_options(raypool_warnings INTERFACE -Wall -Wextra $<$<BOOL:${RAYPOOL_WERROR}>:-Werror>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-uninitialized --param=ggc-min-expand=30
  $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},aarch64>:-Wno-psabi>>)
# For what would take more than 600 MB to compile all the same.
add_library(raypool_frugal INTERFACE)
target_compile_options(raypool_frugal INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-expand=10>)
if(RAYPOOL_SANITIZE)
  target_compile_definitions(raypool_flags INTERFACE RAYPOOL_SANITIZED)
  target_compile_options(raypool_warnings INTERFACE -fsanitize=${RAYPOOL_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(raypool_warnings INTERFACE -fsanitize=${RAYPOOL_SANITIZE})
endif()

# The large headers of others, parsed once for kernels and once for what is not hot (whose options differ). Presets that
# compile every file by itself do without, so that no file lacks an include.
function(raypool_precompile_headers owner)
  target_precompile_headers(${owner} PRIVATE <algorithm> <functional> <map> <memory> <string> <vector>
                            <experimental/simd> <Eigen/Core> <fmt/format.h> ${ARGN})
endfunction()
