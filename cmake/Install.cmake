# SPDX-License-Identifier: MIT
# What `make install` and the Debian package hold: programs, scenes, manual pages, completion.
install(TARGETS rayshade DESTINATION ${CMAKE_INSTALL_BINDIR})
if(TARGET spd)
  install(PROGRAMS $<TARGET_FILE:spd> DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME rayshade-spd)
endif()
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rayshade/scenes
  FILES_MATCHING PATTERN "*.ray" PATTERN "*.png" PATTERN "*.ppm" PATTERN "*.hf" PATTERN "*.map" PATTERN "spd" EXCLUDE)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rayshade)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The rayshade/pafas developers <rayshade@users.noreply.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "ray tracer for Rayshade 4.0 scenes")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "ray tracer for Rayshade 4.0 scenes
 Renders scenes in the language of Rayshade 4.0 on all cores of one machine:
 all shapes, constructive solid geometry, textures, lights, media, atmosphere
 and animation. The picture is the same, byte for byte, whatever the number of
 threads. Writes PNG, PPM, PFM, OpenEXR and Utah RLE.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_STRIP_FILES ON)
