# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` copies beside the program: utilities, examples and documents.
#
#   <bindir>/dd3                   the utilities, a link to the launcher beside their package
#   <datadir>/dd3imp/python        their package
#   <datadir>/dd3imp/input_files   the examples
#   <docdir>                       the documents, with a link to the examples, so that their own links hold
#
#   DD3_SITE_PACKAGES   folder below the prefix where Python looks for packages, for a link to the package; by default
#                       there is none, and `import dd3` needs PYTHONPATH
set(DD3_SITE_PACKAGES "" CACHE STRING "Folder below the prefix for a link to the Python package, such as lib/python3/dist-packages")
set(data "${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME}")
install(PROGRAMS utils/launcher.py DESTINATION "${data}/python" COMPONENT utilities)
install(DIRECTORY utils/dd3 DESTINATION "${data}/python" COMPONENT utilities PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY input_files DESTINATION "${data}" USE_SOURCE_PERMISSIONS COMPONENT examples PATTERN "*.out" EXCLUDE
  PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md CITATION.cff CODE_OF_CONDUCT.md CONTRIBUTING.md LICENSE SECURITY.md
  DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documents)
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documents)

# Install a symbolic link of a component at `place` to `target`, both relative to the prefix.
function(dd3_link target place component)
  cmake_path(GET place PARENT_PATH folder)
  install(CODE "
    set(prefix \"\${CMAKE_INSTALL_PREFIX}\")
    cmake_path(ABSOLUTE_PATH prefix NORMALIZE)
    cmake_path(APPEND prefix \"${target}\" OUTPUT_VARIABLE target)
    cmake_path(APPEND prefix \"${folder}\" OUTPUT_VARIABLE folder)
    cmake_path(APPEND prefix \"${place}\" OUTPUT_VARIABLE place)
    cmake_path(RELATIVE_PATH target BASE_DIRECTORY \"\${folder}\")
    file(MAKE_DIRECTORY \"\$ENV{DESTDIR}\${folder}\")
    message(STATUS \"Installing: \$ENV{DESTDIR}\${place}\")
    file(CREATE_LINK \"\${target}\" \"\$ENV{DESTDIR}\${place}\" SYMBOLIC)"
    COMPONENT ${component})
endfunction()

dd3_link("${data}/python/launcher.py" "${CMAKE_INSTALL_BINDIR}/dd3" utilities)
dd3_link("${data}/input_files" "${CMAKE_INSTALL_DOCDIR}/input_files" documents)
if(DD3_SITE_PACKAGES)
  dd3_link("${data}/python/dd3" "${DD3_SITE_PACKAGES}/dd3" utilities)
endif()
