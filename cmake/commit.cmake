cmake_minimum_required(VERSION 3.22)
# Writes the commit of SOURCE, with "-dirty" when files differ from it, to OUTPUT as a C++ header, if it changed.
execute_process(COMMAND git describe --always --dirty --abbrev=12 --exclude=* WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define RAYPOOL_COMMIT \"@commit@\"\n" @ONLY)
