# The compiler for GPUs, where there is one, and the flags that an image depends on, as in flags.cmake:
#
# -fmad=false                        a fused multiply-add happens only where the source says so
# -ftz=true                          denormal numbers are zero, as in every thread of an engine
# -prec-div=true -prec-sqrt=true     division and square root are rounded to nearest
# Not here, ever: --use_fast_math. tests/gpu/ptx_opcodes_test.py holds what nvcc makes of it.
find_program(RAYPOOL_NVCC nvcc HINTS /usr/local/cuda/bin)
if(RAYPOOL_NVCC)
  execute_process(COMMAND ${RAYPOOL_NVCC} --version OUTPUT_VARIABLE nvcc_version)
  string(REGEX MATCH "release ([0-9]+)" _ "${nvcc_version}")
  if(CMAKE_MATCH_1 LESS 12)
    message(STATUS "${RAYPOOL_NVCC} is older than CUDA 12: the GPU engine is not built")
    set(RAYPOOL_NVCC "")
  endif()
else()
  message(STATUS "nvcc is not here: the GPU engine is not built")
endif()

set(RAYPOOL_NVCC_ROUNDING -fmad=false -ftz=true -prec-div=true -prec-sqrt=true)
set(RAYPOOL_NVCC_FLAGS -std=c++20 --expt-relaxed-constexpr -diag-suppress 20012,20013,20015 -Werror all-warnings
    -DEIGEN_DONT_PARALLELIZE -DEIGEN_DONT_VECTORIZE $<$<BOOL:${RAYPOOL_ONE_FEATURE_SET}>:-DRAYPOOL_ONE_FEATURE_SET>
    -I ${PROJECT_SOURCE_DIR} -isystem /usr/include/eigen3)
# Which chips the kernels are compiled for: the last of them also as PTX, for those to come.
set(RAYPOOL_CUDA_ARCHS "80;86;89;90" CACHE STRING "Compute capabilities that the GPU engine is compiled for")

# raypool_nvcc(SOURCE OUT flags...)
function(raypool_nvcc source out)
  add_custom_command(OUTPUT ${out}
    COMMAND ${RAYPOOL_NVCC} ${RAYPOOL_NVCC_FLAGS} ${ARGN} -MD -MT ${out} -MF ${out}.d ${PROJECT_SOURCE_DIR}/${source} -o ${out}
    DEPENDS ${PROJECT_SOURCE_DIR}/${source} DEPFILE ${out}.d COMMAND_EXPAND_LISTS VERBATIM)
endfunction()

# raypool_nvcc_object(SOURCE OUT): for all chips, to be linked with raypool_cuda.
function(raypool_nvcc_object source out)
  foreach(arch ${RAYPOOL_CUDA_ARCHS})
    list(APPEND codes -gencode=arch=compute_${arch},code=sm_${arch})
  endforeach()
  list(GET RAYPOOL_CUDA_ARCHS -1 newest)
  list(APPEND codes -gencode=arch=compute_${newest},code=compute_${newest})
  raypool_nvcc(${source} ${out} -O3 ${RAYPOOL_NVCC_ROUNDING} -ccbin ${CMAKE_CXX_COMPILER} -Xcompiler -march=${RAYPOOL_ARCH} ${codes} -c)
  set_source_files_properties(${out} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
endfunction()
