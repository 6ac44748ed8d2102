# What `cmake --install` copies beside the program: utilities, examples and documents.
#
#   <bindir>/dd3imp-report ...     the utilities by name, links to
#   <datadir>/dd3imp/utils         the utilities; their Python environment is made by install_needed.sh as .venv beside it
#   <datadir>/dd3imp/input_files   the examples
#   <docdir>                       the documents, with links to examples and utilities, so that their own links hold
include(GNUInstallDirs)
set(data "${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME}")
set(commands tool mesh report section identify plot_force plot_increments plot_point plot_sheet)
# Scripts of the project's own studies and pictures.
set(internal benchmark bending_tables law_pictures plot_study study study_report)
list(TRANSFORM commands PREPEND utils/ OUTPUT_VARIABLE scripts)
list(TRANSFORM scripts APPEND .py)
file(GLOB modules RELATIVE "${CMAKE_SOURCE_DIR}" CONFIGURE_DEPENDS utils/*.py)
list(TRANSFORM internal REPLACE "(.+)" "utils/\\1.py")
list(REMOVE_ITEM modules ${scripts} ${internal})
install(PROGRAMS ${scripts} utils/install_needed.sh DESTINATION "${data}/utils")
install(FILES ${modules} utils/requirements.txt DESTINATION "${data}/utils")
install(DIRECTORY utils/tools DESTINATION "${data}/utils" FILES_MATCHING PATTERN "*.py")
install(DIRECTORY input_files DESTINATION "${data}" USE_SOURCE_PERMISSIONS PATTERN "*.out" EXCLUDE
  PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
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

foreach(name IN LISTS commands)
  dd3_link("${data}/utils/${name}.py" "${CMAKE_INSTALL_BINDIR}/${PROJECT_NAME}-${name}")
endforeach()
foreach(folder IN ITEMS utils input_files)
  dd3_link("${data}/${folder}" "${CMAKE_INSTALL_DOCDIR}/${folder}")
endforeach()
