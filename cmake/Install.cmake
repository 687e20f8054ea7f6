# SPDX-License-Identifier: MIT
# What `make install` and the Debian package hold: programs, scenes, manual pages, completion.
install(TARGETS rayshade DESTINATION ${CMAKE_INSTALL_BINDIR})
# Programs installed under another name are not stripped by CMake itself.
install(PROGRAMS $<TARGET_FILE:spd> DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME rayshade-spd)
install(CODE "if(CMAKE_INSTALL_DO_STRIP)
  execute_process(COMMAND \"${CMAKE_STRIP}\" --remove-section=.comment
    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/rayshade-spd\"
    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/rayshade\" COMMAND_ERROR_IS_FATAL ANY)
endif()")
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rayshade/scenes
  FILES_MATCHING PATTERN "*.ray" PATTERN "*.png" PATTERN "*.ppm" PATTERN "*.hf" PATTERN "*.map" PATTERN "*.pgm" PATTERN "*.inc" PATTERN "spd" EXCLUDE)
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/rayshade)
install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/rayshade)

# Files that Debian's policy wants compressed, without name and time so that the package is reproducible.
function(install_compressed file folder name)
  set(out ${CMAKE_BINARY_DIR}/compressed/${name}.gz)
  add_custom_command(OUTPUT ${out} COMMAND sh -c "gzip -9nc '${file}' > '${out}'" DEPENDS ${file} VERBATIM)
  add_custom_target(compressed_${name} ALL DEPENDS ${out})
  install(FILES ${out} DESTINATION ${folder})
endfunction()
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/compressed)
install_compressed(${CMAKE_BINARY_DIR}/man/rayshade.1 ${CMAKE_INSTALL_MANDIR}/man1 rayshade.1)
install_compressed(${PROJECT_SOURCE_DIR}/man/rayshade.5 ${CMAKE_INSTALL_MANDIR}/man5 rayshade.5)
install_compressed(${PROJECT_SOURCE_DIR}/packaging/changelog ${CMAKE_INSTALL_DATADIR}/doc/rayshade changelog)
install_compressed(${PROJECT_SOURCE_DIR}/man/rayshade-spd.1 ${CMAKE_INSTALL_MANDIR}/man1 rayshade-spd.1)
install(FILES ${CMAKE_BINARY_DIR}/man/rayshade.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME rayshade)

# The renderer alone: the library for programs of others is a component of its own (fas/CMakeLists.txt).
set(CPACK_INSTALL_CMAKE_PROJECTS "${CMAKE_BINARY_DIR};rayshade;Unspecified;/")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rayshade)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The rayshade/pafas developers <rayshade@users.noreply.github.com>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "ray tracer for Rayshade 4.0 scenes")
# CPack itself puts the summary before it and indents it.
set(CPACK_PACKAGE_DESCRIPTION
"Renders scenes in the language of Rayshade 4.0 on all cores of one machine:
all shapes, constructive solid geometry, textures, lights, media, atmosphere
and animation. The picture is the same, byte for byte, whatever the number of
threads. Writes PNG, PPM, PFM, OpenEXR and Utah RLE.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
include(CPack)
