# A Debian package of what `cmake --install` puts in place: `cpack` in a build folder. It is for the processor that the build
# is for: the preset portable makes one for any x86-64 machine with AVX2.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the raypool developers <raypool@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_FILE_NAME raypool)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # the libraries that the command is linked with
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-jinja2, python3-matplotlib, python3-numpy")  # of `raypool study` and `report`
include(CPack)
