# Tests of the benchmarks that bench/ builds where Google Benchmark is found: every row runs and its check holds. A debug
# build, and so every build under a sanitizer, refuses to time anything.

foreach(name IN LISTS raypool_benchmarks)
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    set(options "")
    if(name STREQUAL "engine")
      set(options "--benchmark_filter=threads:2")  # the others take as long again
    endif()
    add_test(NAME bench_${name}
             COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/bench/run_benchmark.py
                     $<TARGET_FILE:${name}_benchmark> ${options})
    set_tests_properties(bench_${name} PROPERTIES LABELS bench ENVIRONMENT OMP_WAIT_POLICY=passive)
  else()
    add_test(NAME bench_${name}_refuses COMMAND ${name}_benchmark)
    set_tests_properties(bench_${name}_refuses PROPERTIES LABELS bench
                                                          PASS_REGULAR_EXPRESSION "a debug build does not benchmark")
  endif()
endforeach()
