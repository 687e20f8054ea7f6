# SPDX-License-Identifier: MIT
# The simulator of clusters; it does without MPI.
add_library(pafas_simulate STATIC ${CMAKE_CURRENT_LIST_DIR}/simulator.cpp)
target_link_libraries(pafas_simulate PUBLIC rayshade_cli rayshade_schedule PRIVATE fmt::fmt)
