# The compiler for GPUs, where there is one, and the flags that an image depends on, as in flags.cmake:
#
# -fmad=false                        a fused multiply-add happens only where the source says so
# -ftz=true                          denormal numbers are zero, as in every thread of an engine
# -prec-div=true -prec-sqrt=true     division and square root are rounded to nearest
# Not here, ever: --use_fast_math. tests/gpu/ptx_opcodes_test.py holds what nvcc makes of it.
option(RAYPOOL_BUILD_GPU "Build the GPU engine where nvcc is" ON)
set(RAYPOOL_NVCC "")
if(RAYPOOL_BUILD_GPU)
  find_package(CUDAToolkit 12 QUIET)
endif()
if(CUDAToolkit_FOUND AND CUDAToolkit_NVCC_EXECUTABLE AND TARGET CUDA::cudart_static)
  # nvcc takes the compilers of its own time alone.
  file(WRITE ${PROJECT_BINARY_DIR}/nvcc_trial.cu "#include <array>\n__global__ void trial() {}\n")
  execute_process(COMMAND ${CUDAToolkit_NVCC_EXECUTABLE} -std=c++20 -ccbin ${CMAKE_CXX_COMPILER} -arch=compute_80 -cubin
                          -code=sm_80 ${PROJECT_BINARY_DIR}/nvcc_trial.cu -o ${PROJECT_BINARY_DIR}/nvcc_trial.cubin
                  RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(NOT failed)
    set(RAYPOOL_NVCC ${CUDAToolkit_NVCC_EXECUTABLE})
  endif()
endif()
if(RAYPOOL_NVCC)
  message(STATUS "The GPU engine is built by ${RAYPOOL_NVCC}")
else()
  message(STATUS "The GPU engine is not built: no nvcc of CUDA 12 or later that takes this compiler")
endif()

get_target_property(eigen Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set(RAYPOOL_NVCC_ROUNDING -fmad=false -ftz=true -prec-div=true -prec-sqrt=true)
set(RAYPOOL_NVCC_FLAGS -std=c++20 --expt-relaxed-constexpr -diag-suppress 20012,20013,20015 -Werror all-warnings
    -DEIGEN_DONT_PARALLELIZE -DEIGEN_DONT_VECTORIZE $<$<BOOL:${RAYPOOL_ONE_FEATURE_SET}>:-DRAYPOOL_ONE_FEATURE_SET>
    -I ${PROJECT_SOURCE_DIR} -isystem ${eigen})
# One virtual architecture, whose PTX the tests prove; and the chips for which ptxas makes machine code of it.
set(RAYPOOL_NVCC_ARCH 80)
set(RAYPOOL_CUDA_CHIPS "80;86;89;90" CACHE STRING "Compute capabilities that the GPU engine has machine code for")

# raypool_nvcc(SOURCE OUT flags...)
function(raypool_nvcc source out)
  add_custom_command(OUTPUT ${out}
    COMMAND ${RAYPOOL_NVCC} ${RAYPOOL_NVCC_FLAGS} ${ARGN} -MD -MT ${out} -MF ${out}.d ${PROJECT_SOURCE_DIR}/${source} -o ${out}
    DEPENDS ${PROJECT_SOURCE_DIR}/${source} DEPFILE ${out}.d COMMAND_EXPAND_LISTS VERBATIM)
endfunction()

# raypool_nvcc_object(SOURCE OUT): for all chips, to be linked with raypool_cuda.
function(raypool_nvcc_object source out)
  list(TRANSFORM RAYPOOL_CUDA_CHIPS PREPEND sm_ OUTPUT_VARIABLE codes)
  list(APPEND codes compute_${RAYPOOL_NVCC_ARCH})  # for chips to come
  list(JOIN codes , codes)
  raypool_nvcc(${source} ${out} -O3 ${RAYPOOL_NVCC_ROUNDING} -ccbin ${CMAKE_CXX_COMPILER} -Xcompiler ${RAYPOOL_ARCH_FLAG}
    -gencode=arch=compute_${RAYPOOL_NVCC_ARCH},code=[${codes}] -c)
  set_source_files_properties(${out} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
endfunction()
