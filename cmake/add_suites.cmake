# Run by ctest when it starts: one entry a suite of the test program PROGRAM, named "NAME/Suite", in one process: to start a
# program that links OpenCV and GDAL costs 0.1 to 0.2 s, more than most cases take.
#   TOGETHER  a list of "Name*": the suites whose names begin so are one entry, "NAME/Name"
# An entry is skipped where all of its cases are; `make test` lists single cases that were skipped.

cmake_policy(VERSION 3.25)

if(NOT EXISTS "${PROGRAM}")
  add_test("${NAME}/not_built" "${PROGRAM}")
  return()
endif()
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status TIMEOUT 600)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${status}")
endif()

set(all_skipped "\\[  PASSED  \\] 0 tests\\.\n\\[  SKIPPED \\] [0-9]+ tests?, listed below:\n(\\[  SKIPPED \\] [^\n]+\n*)+$")
# A line that does not begin with a space is a suite: "Suite." or "Suite/0.  # TypeParam = ...".
string(REGEX MATCHALL "(^|\n)[^ \n]+\\.( [^\n]*)?\n" lines "${listed}")
set(filters "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^\n?([^ \n]+)\\..*$" "\\1" suite "${line}")
  set(filter "${suite}.*")
  foreach(pattern IN LISTS TOGETHER)
    string(REPLACE "*" "" prefix "${pattern}")
    string(FIND "${suite}" "${prefix}" at)
    if(at EQUAL 0)
      set(suite "${prefix}")
      set(filter "${pattern}.*")
    endif()
  endforeach()
  if(NOT filter IN_LIST filters)
    list(APPEND filters "${filter}")
    add_test("${NAME}/${suite}" "${PROGRAM}" "--gtest_filter=${filter}")
    set_tests_properties("${NAME}/${suite}" PROPERTIES SKIP_REGULAR_EXPRESSION "${all_skipped}")
  endif()
endforeach()
