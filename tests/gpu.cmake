# What proves the GPU engine without a GPU: the kernels' bodies run by the host, everywhere; and where nvcc is, the PTX
# that it makes of them, translated and run.

raypool_test(gpu_test equivalence gpu/host_device_test.cpp)
target_link_libraries(gpu_test PRIVATE raypool_gpu GTest::gmock)
target_compile_definitions(gpu_test PRIVATE RAYPOOL_FAILURE_FOLDER="${CMAKE_CURRENT_BINARY_DIR}/failed")

if(NOT RAYPOOL_NVCC OR RAYPOOL_SANITIZE)
  message(STATUS "Tests of the GPU engine: the kernels' bodies are run by the host; their PTX is not, for want of nvcc or "
                 "beside sanitizers")
  return()
endif()

set(translate ${CMAKE_CURRENT_SOURCE_DIR}/gpu/ptx/translate.py)
# raypool_ptx(NAME SOURCE TEST LEVEL flags...): the program NAME: TEST, and the PTX that nvcc makes of SOURCE with these
# flags, translated, which g++ optimises as far as LEVEL says.
function(raypool_ptx name source test level)
  set(ptx ${CMAKE_CURRENT_BINARY_DIR}/${name}.ptx)
  set(cpp ${CMAKE_CURRENT_BINARY_DIR}/${name}_translated.cpp)
  raypool_nvcc(${source} ${ptx} -arch=compute_${RAYPOOL_NVCC_ARCH} -ptx ${ARGN})
  add_custom_command(OUTPUT ${cpp} COMMAND Python3::Interpreter ${translate} ${ptx} ${cpp} DEPENDS ${ptx} ${translate}
                     VERBATIM)
  add_executable(${name} ${test} gpu/ptx/machine.cpp ${cpp})
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
  set_source_files_properties(${cpp} PROPERTIES SKIP_PRECOMPILE_HEADERS ON COMPILE_OPTIONS
    "${level};-Wno-unused-function;-Wno-unused-label;-Wno-unused-variable;-Wno-unused-but-set-variable;-Wno-overflow")
  raypool_gpu_program(${name})
endfunction()
# In a bundle for another machine (scripts/gpu_bundle) they find scenes where they are run, and are not run where they
# are built.
set(RAYPOOL_GPU_SCENES ${PROJECT_SOURCE_DIR} CACHE STRING "Where tests on a GPU look for the folder scenes")
function(raypool_gpu_program name)
  target_precompile_headers(${name} REUSE_FROM raypool_precompiled_not_hot)
  target_link_libraries(${name} PRIVATE raypool_gpu raypool_recursive raypool_core raypool_not_hot GTest::gtest_main
                                        raypool_warnings)
  target_compile_definitions(${name} PRIVATE RAYPOOL_SOURCE_DIR="${RAYPOOL_GPU_SCENES}" RAYPOOL_FAILURE_FOLDER="out/failed")
endfunction()

raypool_ptx(gpu_ptx_test gpu/kernels.cu gpu/ptx_test.cpp -O1 ${RAYPOOL_NVCC_ROUNDING})
raypool_ptx(gpu_ptx_operations_test tests/gpu/operations.cu gpu/ptx_operations_test.cpp -O1 ${RAYPOOL_NVCC_ROUNDING})

# On a GPU, where there is one.
raypool_nvcc_object(tests/gpu/operations.cu ${CMAKE_CURRENT_BINARY_DIR}/operations.o)
add_executable(gpu_cuda_test gpu/cuda_test.cpp ${CMAKE_CURRENT_BINARY_DIR}/operations.o)
raypool_gpu_program(gpu_cuda_test)
target_link_libraries(gpu_cuda_test PRIVATE raypool_cuda)
foreach(program gpu_ptx_test gpu_ptx_operations_test gpu_cuda_test)
  gtest_discover_tests(${program} PROPERTIES LABELS equivalence DISCOVERY_TIMEOUT 60 DISCOVERY_MODE PRE_TEST)
endforeach()

# Were the compiler to fuse operations or to approximate them, it would be found out, by one scene.
raypool_ptx(gpu_fused_ptx gpu/kernels.cu gpu/ptx_test.cpp -O0 -fmad=true -ftz=true -prec-div=true -prec-sqrt=true)
raypool_ptx(gpu_fast_ptx gpu/kernels.cu gpu/ptx_test.cpp -O0 -use_fast_math)
foreach(mutant gpu_fused_ptx gpu_fast_ptx)
  add_test(NAME ${mutant} COMMAND ${mutant} --gtest_filter=*/PtxForms.*/paper)
  set_tests_properties(${mutant} PROPERTIES LABELS equivalence PASS_REGULAR_EXPRESSION "hash [0-9a-f]+ in place of [0-9a-f]+")
endforeach()

add_test(NAME gpu_opcodes
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/gpu/ptx_opcodes_test.py gpu_ptx_test.ptx gpu_fused_ptx.ptx
                 gpu_fast_ptx.ptx
         WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
set_tests_properties(gpu_opcodes PROPERTIES LABELS unit)
