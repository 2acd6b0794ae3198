# `cmake --install`: the command, the libraries with their headers, and the package that find_package(raypool) finds.
#
# A consumer links raypool::core or an engine (raypool::recursive, raypool::wavefront, raypool::gpu) and includes "core/scene/scene.h". The compiler
# flags come along with raypool::flags, as they must: kernels are templates in headers, and an image depends on how
# they are compiled.

include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/raypool)

install(TARGETS raypool)
# What the command says of itself: the manual page, and the completion for bash.
install(CODE "
  foreach(page IN ITEMS man:share/man/man1/raypool.1 bash:share/bash-completion/completions/raypool)
    string(REPLACE : \";\" page \${page})
    list(GET page 0 kind)
    list(GET page 1 file)
    set(file \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/\${file})
    get_filename_component(folder \${file} DIRECTORY)
    file(MAKE_DIRECTORY \${folder})
    execute_process(COMMAND $<TARGET_FILE:raypool> manual \${kind} OUTPUT_FILE \${file} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()")
# The static libraries name the warnings they were built with; who links them does not get those.
set_target_properties(raypool_warnings PROPERTIES EXPORT_NAME warnings)
install(TARGETS raypool_flags raypool_warnings EXPORT raypoolTargets)
set(engines raypool_recursive raypool_wavefront raypool_gpu)
set(raypool_has_cuda OFF)
if(TARGET raypool_cuda)
  set(raypool_has_cuda ON)
  list(APPEND engines raypool_cuda)
endif()
foreach(target IN LISTS raypool_layers engines)
  string(REPLACE raypool_ "" name ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${target} EXPORT raypoolTargets INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raypool)
endforeach()
foreach(folder IN ITEMS core recursive wavefront gpu)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raypool FILES_MATCHING PATTERN "*.h")
endforeach()

install(EXPORT raypoolTargets NAMESPACE raypool:: DESTINATION ${package_dir})
configure_package_config_file(cmake/raypoolConfig.cmake.in raypoolConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(raypoolConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/raypoolConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/raypoolConfigVersion.cmake
        DESTINATION ${package_dir})
