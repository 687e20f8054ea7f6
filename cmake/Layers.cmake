# SPDX-License-Identifier: MIT
# add_layer(NAME [DEPENDS LAYER...] [LINK LIB...]): one folder, one static library rayshade_NAME holding every *.cpp
# of the folder except *_test.cpp and main.cpp; a layer may include headers of the layers it names, and of no other.
function(add_layer name)
  cmake_parse_arguments(LAYER "" "" "DEPENDS;LINK;SOURCES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/*/*.cpp)
  list(FILTER sources EXCLUDE REGEX "(_test|/main)\\.cpp$")
  add_library(rayshade_${name} STATIC ${sources} ${LAYER_SOURCES})
  target_link_libraries(rayshade_${name} PUBLIC rayshade_flags)
  foreach(dep ${LAYER_DEPENDS})
    target_link_libraries(rayshade_${name} PUBLIC rayshade_${dep})
  endforeach()
  target_link_libraries(rayshade_${name} PRIVATE ${LAYER_LINK})
endfunction()
