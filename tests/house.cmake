# Tests of what surrounds the code: the installed package, the documentation, the sanitizer's set-up.

set(Python3_ROOT_DIR /usr)  # the python3 that the distribution's packages (python3-jsonschema) are for
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME documentation
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/docs/check_docs.py ${PROJECT_SOURCE_DIR} $<TARGET_FILE:raypool>)
set_tests_properties(documentation PROPERTIES LABELS slow COST 100  # begun first, not to end last
                                              ENVIRONMENT OMP_WAIT_POLICY=passive)

if(CMAKE_BUILD_TYPE STREQUAL Release)  # pictures of 64 samples a pixel
  add_test(NAME gallery COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/draw_gallery $<TARGET_FILE:raypool> --check)
  set_tests_properties(gallery PROPERTIES LABELS slow)

  # These run nothing that is built.
  add_test(NAME layers COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/layers_test.py ${PROJECT_SOURCE_DIR})
  set_tests_properties(layers PROPERTIES LABELS unit)

  foreach(name build crossover efficiency gpu load page report report_browser results scene_size traversal)
    add_test(NAME analysis_${name}
             COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/analysis/${name}_test.py ${PROJECT_SOURCE_DIR})
    set_tests_properties(analysis_${name} PROPERTIES LABELS unit)
  endforeach()
  # Chromium takes 400 MB, so scripts/install_dependencies leaves it out; the test says when it finds none.
  set_tests_properties(analysis_report_browser PROPERTIES SKIP_RETURN_CODE 77 LABELS slow)
endif()

if(RAYPOOL_SANITIZE MATCHES thread)
  # Without Archer, ThreadSanitizer takes the barriers of OpenMP for races. libomp loads it by itself where it finds it.
  add_test(NAME archer COMMAND equivalence_test --gtest_filter=*HashMatrix*two_pixels*)
  set_tests_properties(archer PROPERTIES ENVIRONMENT ARCHER_OPTIONS=verbose=1 LABELS equivalence
                                         PASS_REGULAR_EXPRESSION "Archer detected OpenMP application")
endif()

if(NOT RAYPOOL_SANITIZE)  # sanitizers are no part of the package
  set(prefix ${CMAKE_CURRENT_BINARY_DIR}/installed)
  add_test(NAME install COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --prefix ${prefix})
  add_test(NAME consumer
           COMMAND ${CMAKE_CTEST_COMMAND}
                   --build-and-test ${CMAKE_CURRENT_SOURCE_DIR}/consumer ${CMAKE_CURRENT_BINARY_DIR}/consumer
                   --build-generator ${CMAKE_GENERATOR}
                   --build-options -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
                                   -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
                   --test-command consumer)
  set_tests_properties(install PROPERTIES FIXTURES_SETUP installed)
  set_tests_properties(consumer PROPERTIES FIXTURES_REQUIRED installed)
endif()

# The Debian package, as far as it can be tried without installing it.
find_program(RAYPOOL_DPKG_DEB dpkg-deb)
if(RAYPOOL_DPKG_DEB AND NOT RAYPOOL_SANITIZE)
  add_test(NAME package COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/package_test.py ${PROJECT_BINARY_DIR})
  set_tests_properties(package PROPERTIES LABELS slow)
endif()
