# SPDX-License-Identifier: MIT
# PNG files are built by hand with zlib, EXR files read back with the library itself.
target_link_libraries(image_test PRIVATE ZLIB::ZLIB Threads::Threads)
if(OPENEXR_FOUND)
  target_link_libraries(image_test PRIVATE PkgConfig::OPENEXR)
endif()
