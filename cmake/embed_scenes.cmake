# raypool_embed_scenes(<target>) compiles scenes/*.json into the target: the texts that core/scene/builtin_scenes.h declares.
# A changed, new or removed scene makes the next build run CMake again.

function(raypool_embed_scenes target)
  set(piece_length 32000)  # bytes; compilers need not take literals of more than 65536
  set(folder "${PROJECT_SOURCE_DIR}/scenes")
  set(output "${CMAKE_CURRENT_BINARY_DIR}/builtin_scenes.cpp")

  file(GLOB scene_files CONFIGURE_DEPENDS "${folder}/*.json")
  list(FILTER scene_files EXCLUDE REGEX "\\.schema\\.json$")
  list(SORT scene_files)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${scene_files})

  set(pieces "")
  set(table "")
  foreach(scene_file IN LISTS scene_files)
    get_filename_component(name "${scene_file}" NAME_WE)
    string(MAKE_C_IDENTIFIER "k_${name}" variable)
    file(READ "${scene_file}" text)
    string(LENGTH "${text}" length)
    string(APPEND pieces "constexpr std::string_view ${variable}[] = {\n")
    set(start 0)
    while(start LESS length)
      string(SUBSTRING "${text}" ${start} ${piece_length} piece)
      string(APPEND pieces "R\"scene(${piece})scene\",\n")
      math(EXPR start "${start} + ${piece_length}")
    endwhile()
    string(APPEND pieces "};\n")
    string(APPEND table "    {\"${name}\", ${variable}},\n")
  endforeach()

  file(GENERATE OUTPUT "${output}" CONTENT "// Generated from scenes/*.json by cmake/embed_scenes.cmake.
#include \"core/scene/builtin_scenes.h\"

namespace raypool {
namespace {

${pieces}
constexpr BuiltinSceneText kTexts[] = {
${table}};

}  // namespace

std::span<const BuiltinSceneText> builtin_scene_texts() { return kTexts; }

}  // namespace raypool
")
  target_sources(${target} PRIVATE "${output}")
endfunction()
