# SPDX-License-Identifier: MIT
# What `make install` and the Debian packages hold: programs, scenes, manual pages, completion. The package pafas is a
# component of its own, as it alone needs MPI.
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
  set(component Unspecified)
  if(ARGC GREATER 3)
    set(component ${ARGV3})
  endif()
  set(out ${CMAKE_BINARY_DIR}/compressed/${component}-${name}.gz)
  add_custom_command(OUTPUT ${out} COMMAND sh -c "gzip -9nc '${file}' > '${out}'" DEPENDS ${file} VERBATIM)
  add_custom_target(compressed_${component}_${name} ALL DEPENDS ${out})
  install(FILES ${out} DESTINATION ${folder} COMPONENT ${component} RENAME ${name}.gz)
endfunction()
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/compressed)
install_compressed(${CMAKE_BINARY_DIR}/man/rayshade.1 ${CMAKE_INSTALL_MANDIR}/man1 rayshade.1)
install_compressed(${PROJECT_SOURCE_DIR}/man/rayshade.5 ${CMAKE_INSTALL_MANDIR}/man5 rayshade.5)
install_compressed(${PROJECT_SOURCE_DIR}/packaging/changelog ${CMAKE_INSTALL_DATADIR}/doc/rayshade changelog)
install_compressed(${PROJECT_SOURCE_DIR}/man/rayshade-spd.1 ${CMAKE_INSTALL_MANDIR}/man1 rayshade-spd.1)
install(FILES ${CMAKE_BINARY_DIR}/man/rayshade.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME rayshade)

if(TARGET pafas)
  install(TARGETS pafas DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT pafas)
  install(DIRECTORY scenes/batch/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pafas/batch COMPONENT pafas
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  install_compressed(${CMAKE_BINARY_DIR}/man/pafas.1 ${CMAKE_INSTALL_MANDIR}/man1 pafas.1 pafas)
  install_compressed(${PROJECT_SOURCE_DIR}/packaging/changelog ${CMAKE_INSTALL_DATADIR}/doc/pafas changelog pafas)
  install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pafas COMPONENT pafas)
  install(FILES ${CMAKE_BINARY_DIR}/man/pafas.bash
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME pafas COMPONENT pafas)
endif()

# The renderers alone: the library for programs of others is a component of its own (fas/CMakeLists.txt).
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL Unspecified)
if(TARGET pafas)
  list(APPEND CPACK_COMPONENTS_ALL pafas)
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rayshade)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME rayshade)
set(CPACK_DEBIAN_PAFAS_PACKAGE_NAME pafas)
set(CPACK_DEBIAN_PAFAS_PACKAGE_RECOMMENDS rayshade)
set(CPACK_DEBIAN_PAFAS_PACKAGE_DEPENDS openmpi-bin)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The rayshade/pafas developers <rayshade@users.noreply.github.com>")
# Each with its synopsis as the first line. No CPACK_PACKAGE_DESCRIPTION_SUMMARY: CPack would put that before both.
set(CPACK_DEBIAN_UNSPECIFIED_DESCRIPTION "ray tracer for Rayshade 4.0 scenes
Renders scenes in the language of Rayshade 4.0 on all cores of one machine:
all shapes, constructive solid geometry, textures, lights, media, atmosphere
and animation. The picture is the same, byte for byte, whatever the number of
threads. Writes PNG, PPM, PFM, OpenEXR and Utah RLE.")
set(CPACK_DEBIAN_PAFAS_DESCRIPTION "ray tracer for Rayshade 4.0 scenes on clusters
Renders one picture on the machines of a cluster under MPI: the same scenes,
options and bytes as rayshade. Machines may differ in speed, share no disk,
come late and die; an interrupted job goes on where it stopped.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
include(CPack)
