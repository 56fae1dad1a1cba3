# victorious_library(), victorious_tests(), victorious_precompile(), and the levels of layers.toml that they obey.

set(_victorious_layers_file "${CMAKE_CURRENT_LIST_DIR}/../layers.toml")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${_victorious_layers_file}")
file(STRINGS "${_victorious_layers_file}" _victorious_layer_lines REGEX "^\"?[a-z_/]+\"? = [0-9]+$")
foreach(line IN LISTS _victorious_layer_lines)
  string(REGEX MATCH "([a-z_]+)\"? = ([0-9]+)$" _ "${line}")
  set(VICTORIOUS_LEVEL_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
endforeach()

# victorious_precompile(KIND TARGET...): the targets use the precompiled header of KIND:
#   common  the standard library, Eigen, OpenCV's core, fmt: what most sources include
#   tests   common and GoogleTest
#   json    common and the JSON library: what the commands and the server include
# Does nothing without VICTORIOUS_PCH. A source includes what it uses all the same.
function(victorious_precompile kind)
  if(VICTORIOUS_PCH)
    foreach(target IN LISTS ARGN)
      target_precompile_headers(${target} REUSE_FROM victorious_pch_${kind})
      # Without it, ccache does not see the precompiled header in what GCC preprocesses.
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
    endforeach()
  endif()
endfunction()

function(_victorious_precompiled_header kind)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINKS" ${ARGN})
  file(GENERATE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/pch/${kind}.cc" CONTENT "")
  set(target victorious_pch_${kind})
  add_library(${target} OBJECT "${CMAKE_CURRENT_BINARY_DIR}/pch/${kind}.cc")
  target_link_libraries(${target} PRIVATE Eigen3::Eigen opencv_core fmt::fmt ${ARG_LINKS} victorious_warnings)
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <chrono> <cmath> <cstdint> <expected> <filesystem> <functional> <map> <memory> <numeric>
    <optional> <ranges> <set> <span> <string> <string_view> <thread> <utility> <variant> <vector>
    <Eigen/Dense> <fmt/format.h> <nlohmann/json_fwd.hpp> <opencv2/core.hpp> ${ARG_HEADERS})
endfunction()

# victorious_optimise_less(TARGET): compiled in half the time, and as fast where the time goes to what it links.
function(victorious_optimise_less target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

if(VICTORIOUS_PCH)
  _victorious_precompiled_header(common)
  _victorious_precompiled_header(tests HEADERS <gmock/gmock.h> <gtest/gtest.h> LINKS GTest::gmock GTest::gtest)
  victorious_optimise_less(victorious_pch_tests)
  _victorious_precompiled_header(json HEADERS <nlohmann/json.hpp> LINKS nlohmann_json::nlohmann_json)
endif()

# victorious_unity(TARGET): compiles its sources in batches, with VICTORIOUS_UNITY: names in unnamed namespaces are unique in
# the folder.
function(victorious_unity target)
  if(VICTORIOUS_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 9)
  endif()
endfunction()

# One static library a folder of layers.toml, by the last part of its path, which no two share.
#   FOLDERS   the lower folders it includes (checked against layers.toml)
#   PUBLIC    third-party targets whose types stand in its headers
#   PRIVATE   third-party targets that stay inside
#   PCH       its precompiled header (victorious_precompile), or NONE; common if not given
#   UNITY     compiles its sources in batches (victorious_unity)
function(victorious_library name)
  cmake_parse_arguments(ARG "UNITY" "PCH" "SOURCES;FOLDERS;PUBLIC;PRIVATE" ${ARGN})
  if(NOT DEFINED VICTORIOUS_LEVEL_${name})
    message(FATAL_ERROR "${name} is not listed in layers.toml")
  endif()
  set(target victorious_${name})
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE ${ARG_PRIVATE} victorious_warnings)
    if(NOT ARG_PCH)
      set(ARG_PCH common)
    endif()
    if(ARG_UNITY)
      victorious_unity(${target})
    endif()
    if(NOT ARG_PCH STREQUAL NONE)
      victorious_precompile(${ARG_PCH} ${target})
    endif()
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(${target} ${scope} "${PROJECT_SOURCE_DIR}/src")
  foreach(folder IN LISTS ARG_FOLDERS)
    if(NOT VICTORIOUS_LEVEL_${folder} LESS VICTORIOUS_LEVEL_${name})
      message(FATAL_ERROR "${name} (level ${VICTORIOUS_LEVEL_${name}}) links ${folder} (level "
                          "${VICTORIOUS_LEVEL_${folder}}): only lower levels of layers.toml may be linked")
    endif()
    target_link_libraries(${target} ${scope} victorious_${folder})
  endforeach()
  target_link_libraries(${target} ${scope} ${ARG_PUBLIC})
endfunction()

# The tests of one folder: foo_test.cc beside foo.cc, one binary a folder. ctest has an entry for each suite of ALONE, named
# "folder/Suite", and one for all others, "folder/others".
#   ALONE  suites that take some seconds each: entries of their own keep both cores busy. "Name*": the suites whose names
#          begin so share a costly set-up and are one entry, "folder/Name"
#   APART  sources that are compiled by themselves (victorious_unity): names of theirs are those of another source
function(victorious_tests name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;ALONE;APART" ${ARGN})
  set(target ${name}_tests)
  add_executable(${target} ${ARG_SOURCES})
  victorious_unity(${target})
  set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  victorious_optimise_less(${target})
  if(TARGET victorious_${name})
    target_link_libraries(${target} PRIVATE victorious_${name})
  endif()
  target_link_libraries(${target} PRIVATE ${ARG_LINKS} victorious_testing victorious_warnings GTest::gmock GTest::gtest_main)
  victorious_precompile(tests ${target})
  # What reads files that may be hostile starts it.
  if(NOT DEFINED VICTORIOUS_LEVEL_${name} OR NOT VICTORIOUS_LEVEL_${name} LESS VICTORIOUS_LEVEL_mesh)
    add_dependencies(${target} victorious-decoder)
  endif()
  set(suites "${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.txt")
  add_custom_command(TARGET ${target} POST_BUILD COMMAND ${target} --gtest_list_tests > "${suites}" VERBATIM)
  set(entries "${CMAKE_CURRENT_BINARY_DIR}/${target}_entries.cmake")
  file(GENERATE OUTPUT "${entries}" CONTENT
    "set(NAME [[${name}]])\nset(PROGRAM [[$<TARGET_FILE:${target}>]])\nset(SUITES [[${suites}]])\nset(ALONE [[${ARG_ALONE}]])\ninclude([[${PROJECT_SOURCE_DIR}/cmake/add_suites.cmake]])\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${entries}")
endfunction()
