# Read by cpack: the files of the package have the time of the commit, so that the same build gives the same package.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(
    COMMAND git log -1 --format=%ct
    WORKING_DIRECTORY "${CPACK_VICTORIOUS_SOURCE}"
    OUTPUT_VARIABLE time
    OUTPUT_STRIP_TRAILING_WHITESPACE
    ERROR_QUIET)
  if(time MATCHES "^[0-9]+$")
    set(ENV{SOURCE_DATE_EPOCH} "${time}")
  endif()
endif()
