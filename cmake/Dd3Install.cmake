# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` copies beside the program: utilities, examples and documents.
#
#   <bindir>/dd3                   the utilities, a link to dd3.sh
#   <datadir>/dd3imp/utils         their package; install_needed.sh makes its Python environment as .venv beside it
#   <datadir>/dd3imp/input_files   the examples
#   <docdir>                       the documents, with links to examples and utilities, so that their own links hold
set(data "${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME}")
install(PROGRAMS utils/dd3.sh utils/install_needed.sh DESTINATION "${data}/utils")
install(FILES utils/pyproject.toml DESTINATION "${data}/utils")
install(DIRECTORY utils/dd3 DESTINATION "${data}/utils" PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY input_files DESTINATION "${data}" USE_SOURCE_PERMISSIONS PATTERN "*.out" EXCLUDE
  PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}")

# Install a symbolic link at `place` to `target`, both relative to the prefix.
function(dd3_link target place)
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
    file(CREATE_LINK \"\${target}\" \"\$ENV{DESTDIR}\${place}\" SYMBOLIC)")
endfunction()

dd3_link("${data}/utils/dd3.sh" "${CMAKE_INSTALL_BINDIR}/dd3")
foreach(folder IN ITEMS utils input_files)
  dd3_link("${data}/${folder}" "${CMAKE_INSTALL_DOCDIR}/${folder}")
endforeach()
