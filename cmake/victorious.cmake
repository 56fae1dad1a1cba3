# victorious_library(), victorious_tests(), and the levels of layers.toml that both obey.

set(_victorious_layers_file "${CMAKE_CURRENT_LIST_DIR}/../layers.toml")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${_victorious_layers_file}")
file(STRINGS "${_victorious_layers_file}" _victorious_layer_lines REGEX "^[a-z_]+ = [0-9]+$")
foreach(line IN LISTS _victorious_layer_lines)
  string(REGEX MATCH "^([a-z_]+) = ([0-9]+)$" _ "${line}")
  set(VICTORIOUS_LEVEL_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
endforeach()

# One static library a folder of src/victorious.
#   FOLDERS   the lower folders it includes (checked against layers.toml)
#   PUBLIC    third-party targets whose types stand in its headers
#   PRIVATE   third-party targets that stay inside
function(victorious_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;FOLDERS;PUBLIC;PRIVATE" ${ARGN})
  if(NOT DEFINED VICTORIOUS_LEVEL_${name})
    message(FATAL_ERROR "${name} is not listed in layers.toml")
  endif()
  set(target victorious_${name})
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE ${ARG_PRIVATE} victorious_warnings)
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

# The tests of one folder: foo_test.cc beside foo.cc, one binary a folder, one ctest entry a case named "folder/Suite.Case".
function(victorious_tests name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  set(target ${name}_tests)
  add_executable(${target} ${ARG_SOURCES})
  if(TARGET victorious_${name})
    target_link_libraries(${target} PRIVATE victorious_${name})
  endif()
  target_link_libraries(${target} PRIVATE ${ARG_LINKS} victorious_testing victorious_warnings GTest::gmock GTest::gtest_main)
  gtest_discover_tests(${target} TEST_PREFIX "${name}/" DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    PROPERTIES SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
endfunction()
