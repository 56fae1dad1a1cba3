# Tests of the project rules: include layers, format, generated pages.
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)

add_test(NAME house/layers
  COMMAND Python3::Interpreter "${CMAKE_CURRENT_LIST_DIR}/check_layers.py" "${PROJECT_SOURCE_DIR}")
add_test(NAME house/check_layers_test
  COMMAND Python3::Interpreter "${CMAKE_CURRENT_LIST_DIR}/check_layers_test.py")
add_test(NAME house/chapter_page_test
  COMMAND Python3::Interpreter "${CMAKE_CURRENT_LIST_DIR}/chapter_page_test.py")
add_test(NAME house/format
  COMMAND "${CMAKE_CURRENT_LIST_DIR}/check_format.sh" "${PROJECT_SOURCE_DIR}")
set_tests_properties(house/format PROPERTIES SKIP_RETURN_CODE 77)

add_test(NAME house/parameters
  COMMAND "${CMAKE_CURRENT_LIST_DIR}/parameters.sh" $<TARGET_FILE:victorious> --check "${PROJECT_SOURCE_DIR}/docs/parameters.md")
