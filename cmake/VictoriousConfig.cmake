# find_package(Victorious): the target Victorious::victorious. Its headers need C++17 and the standard library alone.
include("${CMAKE_CURRENT_LIST_DIR}/VictoriousTargets.cmake")
set(${CMAKE_FIND_PACKAGE_NAME}_FOUND TRUE)
