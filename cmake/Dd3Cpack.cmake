# SPDX-License-Identifier: GPL-3.0-or-later
# The package of Debian and the archive of `cmake --workflow --preset package`, see utils/packaging/README.md.
set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_PACKAGE_CONTACT "The dd3imp developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Implicit finite element simulation of sheet metal forming")
set(CPACK_PACKAGE_DESCRIPTION "Implicit finite element simulation of sheet metal forming with rigid tools: the program dd3imp,
its utilities dd3, the constitutive laws as a library for C, examples and documents.")
set(CPACK_RESOURCE_FILE_LICENSE "${CMAKE_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_FILE_NAME "${PROJECT_NAME}-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# pyvista, for pictures of the sheet and the report, is not in Debian 12: dd3 tells how to install it.
set(depends "python3 (>= 3.11)" python3-h5py python3-matplotlib python3-numpy python3-pandas python3-scipy python3-tqdm)
list(JOIN depends ", " CPACK_DEBIAN_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS python3-venv)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${CMAKE_SOURCE_DIR}/utils/packaging/debian/postinst"
  "${CMAKE_SOURCE_DIR}/utils/packaging/debian/prerm")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
