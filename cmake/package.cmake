# What `make install` installs, and the Debian package of `make package`. The manual page and the completions are printed by
# the program itself (`victorious manual`).
include(GNUInstallDirs)

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

# `bench` and `experiment` are programs of their own beside the main one.
install(TARGETS victorious victorious-bench victorious-experiment RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
# The programs start it; a person never does.
install(TARGETS victorious-decoder RUNTIME DESTINATION "libexec/victorious")
install(FILES "${_victorious_pages}/victorious.1.gz" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
install(FILES "${_victorious_pages}/victorious" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")
install(FILES "${_victorious_pages}/_victorious" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions")
install(FILES "${_victorious_pages}/victorious.fish" DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d")
# The page of `victorious serve`, if tools/build_web.sh has built it.
install(DIRECTORY "${CMAKE_BINARY_DIR}/web" DESTINATION "${CMAKE_INSTALL_DATADIR}/victorious" OPTIONAL)
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME copyright)

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
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libegl-mesa0, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "proj-data")
# They show the manual page and load the completion.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "bash-completion, man-db")
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_SOURCE_DIR}/cmake/package_time.cmake")
set(CPACK_VICTORIOUS_SOURCE "${PROJECT_SOURCE_DIR}")
include(CPack)
