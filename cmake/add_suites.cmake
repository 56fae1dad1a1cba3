# Run by ctest when it starts: the entries of the test program PROGRAM, each a process of its own: to start a program that
# links OpenCV and GDAL costs 0.1 to 0.2 s of a processor, more than most suites take.
#   SUITES    the file with what PROGRAM --gtest_list_tests said when it was built
#   ALONE     suites of some seconds each: one entry, "NAME/Suite". "Name*" stands for all whose names begin so, which are
#             one entry, "NAME/Name"
# All others are one entry, "NAME/others". An entry is skipped where all of its cases are; `make test` lists single cases
# that were skipped.

cmake_policy(VERSION 3.25)

if(NOT EXISTS "${PROGRAM}" OR NOT EXISTS "${SUITES}")
  add_test("${NAME}/not_built" "${PROGRAM}")
  return()
endif()
# A line that does not begin with a space is a suite: "Suite." or "Suite/0.  # TypeParam = ...".
file(STRINGS "${SUITES}" lines REGEX "^[^ ]+\\.( |$)")
list(TRANSFORM lines REPLACE "^([^ ]+)\\..*$" "\\1")

function(_add_suites entry filter)
  set(all_skipped
      "\\[  PASSED  \\] 0 tests\\.\n\\[  SKIPPED \\] [0-9]+ tests?, listed below:\n(\\[  SKIPPED \\] [^\n]+\n*)+$")
  add_test("${NAME}/${entry}" "${PROGRAM}" "--gtest_filter=${filter}")
  set_tests_properties("${NAME}/${entry}" PROPERTIES SKIP_REGULAR_EXPRESSION "${all_skipped}")
endfunction()

set(not_others "")
foreach(pattern IN LISTS ALONE)
  string(REPLACE "*" "" entry "${pattern}")
  string(REPLACE "*" ".*" expression "^${pattern}$")
  set(suites ${lines})
  list(FILTER suites INCLUDE REGEX "${expression}")
  list(FILTER lines EXCLUDE REGEX "${expression}")
  if(NOT suites)
    message(FATAL_ERROR "${PROGRAM} has no suite ${pattern}: correct ALONE of its victorious_tests()")
  endif()
  _add_suites("${entry}" "${pattern}.*")
  list(APPEND not_others "${pattern}.*")
endforeach()
if(lines)
  list(JOIN not_others ":" not_others)
  _add_suites(others "*-${not_others}")
endif()
