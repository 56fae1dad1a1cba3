# What `make install` installs, and the Debian package of `make package`. The manual page and the completions are printed by
# the program itself (`victorious manual`).

set(_victorious_pages "${CMAKE_BINARY_DIR}/pages")
add_custom_command(
  OUTPUT "${_victorious_pages}/victorious.1.gz" "${_victorious_pages}/victorious" "${_victorious_pages}/_victorious"
         "${_victorious_pages}/victorious.fish"
  COMMAND "${CMAKE_COMMAND}" -E make_directory "${_victorious_pages}"
  COMMAND victorious manual man > "${_victorious_pages}/victorious.1"
  COMMAND gzip -9 -n -f "${_victorious_pages}/victorious.1"
  COMMAND victorious manual bash > "${_victorious_pages}/victorious"
  COMMAND victorious manual zsh > "${_victorious_pages}/_victorious"
  COMMAND victorious manual fish > "${_victorious_pages}/victorious.fish"
  DEPENDS victorious
  VERBATIM)
add_custom_target(victorious_pages ALL DEPENDS "${_victorious_pages}/victorious.1.gz" "${_victorious_pages}/victorious")

# Installing takes what is built; it does not build the tests first.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)

# `bench` is a program of its own beside the main one; `experiment`, which repeats the thesis, stays with the sources.
install(TARGETS victorious victorious-bench RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
# The programs start it; a person never does.
install(TARGETS victorious-decoder RUNTIME DESTINATION "libexec/victorious" COMPONENT program)
install(FILES "${_victorious_pages}/victorious.1.gz" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program)
install(FILES "${_victorious_pages}/victorious" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program)
install(FILES "${_victorious_pages}/_victorious" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions" COMPONENT program)
install(FILES "${_victorious_pages}/victorious.fish" DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" COMPONENT program)
# The page of `victorious serve`, if tools/build_web.sh has built it.
install(DIRECTORY "${CMAKE_BINARY_DIR}/web" DESTINATION "${CMAKE_INSTALL_DATADIR}/victorious" COMPONENT program OPTIONAL)
# The sample of the page and of `victorious self-test`.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/assets" DESTINATION "${CMAKE_INSTALL_DATADIR}/victorious" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/scenes/demo.json" DESTINATION "${CMAKE_INSTALL_DATADIR}/victorious/scenes" COMPONENT program)
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/victorious" RENAME copyright COMPONENT program)

# The library: `find_package(Victorious)` gives the target Victorious::victorious, pkg-config the package victorious.
include(CMakePackageConfigHelpers)
set(_victorious_cmake "${CMAKE_INSTALL_LIBDIR}/cmake/Victorious")
install(TARGETS victorious_shared EXPORT VictoriousTargets
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT dev)
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libvictorious0.1" RENAME copyright COMPONENT library)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/victorious" "${PROJECT_BINARY_DIR}/include/victorious"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev FILES_MATCHING PATTERN "*.h")
install(EXPORT VictoriousTargets NAMESPACE Victorious:: DESTINATION "${_victorious_cmake}" COMPONENT dev)
# Until version 1.0, a minor version may change what the headers declare.
write_basic_package_version_file("${CMAKE_BINARY_DIR}/VictoriousConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH _victorious_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file("${PROJECT_SOURCE_DIR}/cmake/victorious.pc.in" "${CMAKE_BINARY_DIR}/victorious.pc" @ONLY)
install(FILES "${PROJECT_SOURCE_DIR}/cmake/VictoriousConfig.cmake" "${CMAKE_BINARY_DIR}/VictoriousConfigVersion.cmake"
  DESTINATION "${_victorious_cmake}" COMPONENT dev)
install(FILES "${CMAKE_BINARY_DIR}/victorious.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT dev)
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libvictorious-dev" RENAME copyright COMPONENT dev)

set(CPACK_PACKAGE_NAME victorious)
set(CPACK_PACKAGE_VENDOR "VICTORIOUS")
set(CPACK_PACKAGE_CONTACT "VICTORIOUS maintainers <maintainers@victorious.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "finds objects in video and places them on Earth")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "VICTORIOUS takes photos or a CAD model of an object and hours of video. It
reports the frames in which the object is visible, its outline, and with
telemetry its place on Earth with covariance. Rendering needs neither a
display nor a graphics card.")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# The libraries that the programs are linked with; a software OpenGL renderer is loaded at run time.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libegl-mesa0, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "proj-data")
# They show the manual page and load the completion.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "bash-completion, man-db")
# A package for each component.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program library dev)
if(TARGET victorious_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME victorious)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libvictorious0.1)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "The library of VICTORIOUS for other programs: models of objects, frames of
videos, recognition, tracking, and the index of what was found where.")
# The program's package has victorious-decoder, which reads CAD files for the library, of exactly this version.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "victorious (= ${PROJECT_VERSION}), libegl-mesa0, libgl1-mesa-dri")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libvictorious-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libvictorious0.1 (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_DESCRIPTION "The headers of libvictorious, for CMake and pkg-config.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-victorious)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "libvictorious0.1 (= ${PROJECT_VERSION}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "The module victorious of Python 3: models, videos, recognition and tracking
on numpy arrays, and the index of what was found where.")
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_SOURCE_DIR}/cmake/package_time.cmake")
set(CPACK_VICTORIOUS_SOURCE "${PROJECT_SOURCE_DIR}")
include(CPack)
