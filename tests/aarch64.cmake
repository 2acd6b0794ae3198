# The same images on 64-bit ARM: the engines and their tests, compiled for it and run by an emulator.

find_program(RAYPOOL_AARCH64_CXX aarch64-linux-gnu-g++)
find_program(RAYPOOL_QEMU_AARCH64 NAMES qemu-aarch64 qemu-aarch64-static)
set(googletest /usr/src/googletest/googletest)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64 OR NOT CMAKE_BUILD_TYPE STREQUAL Release OR NOT RAYPOOL_ARCH STREQUAL native
   OR NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU OR NOT RAYPOOL_AARCH64_CXX OR NOT RAYPOOL_QEMU_AARCH64 OR NOT EXISTS ${googletest})
  message(STATUS "Tests for 64-bit ARM: left out on ARM, in all presets but release, and for want of a compiler and an emulator")
  return()
endif()

add_executable(aarch64_scenes aarch64/make_scenes.cpp)
target_precompile_headers(aarch64_scenes REUSE_FROM raypool_precompiled_not_hot)
target_link_libraries(aarch64_scenes PRIVATE raypool_image raypool_not_hot raypool_warnings)

include(ExternalProject)
include(ProcessorCount)
ProcessorCount(cores)
set(folder ${CMAKE_CURRENT_BINARY_DIR}/aarch64)
ExternalProject_Add(raypool_aarch64
  SOURCE_DIR ${CMAKE_CURRENT_SOURCE_DIR}/aarch64
  BINARY_DIR ${folder}
  CMAKE_ARGS -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER=${RAYPOOL_AARCH64_CXX}
             -DCMAKE_CXX_FLAGS= -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O1 -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=5
             -DRAYPOOL_WERROR=${RAYPOOL_WERROR} -DRAYPOOL_SCENES=${folder}/scenes -DGOOGLETEST=${googletest}
  BUILD_COMMAND ${CMAKE_COMMAND} --build ${folder} --parallel ${cores}
  BUILD_ALWAYS ON
  INSTALL_COMMAND "")

add_test(NAME aarch64_scenes COMMAND aarch64_scenes ${PROJECT_SOURCE_DIR} ${folder}/scenes)
set_tests_properties(aarch64_scenes PROPERTIES FIXTURES_SETUP aarch64_scenes LABELS equivalence)
# raypool_aarch64_test(NAME FILTER): the tests that a filter of GoogleTest names.
function(raypool_aarch64_test name filter)
  add_test(NAME aarch64_${name} COMMAND ${RAYPOOL_QEMU_AARCH64} ${folder}/aarch64_test --gtest_filter=${filter})
  set_tests_properties(aarch64_${name} PROPERTIES FIXTURES_REQUIRED aarch64_scenes LABELS equivalence
                                                  FAIL_REGULAR_EXPRESSION "Running 0 tests"
                                                  ENVIRONMENT OMP_WAIT_POLICY=passive)
endfunction()
raypool_aarch64_test(operations *Operations*:FlushDenormals*)
raypool_aarch64_test(golden *Golden*)
raypool_aarch64_test(engines -*Operations*:FlushDenormals*:*Golden*:*EveryPool*:ImageAttributes*)  # PNG and EXR are not there
