# SPDX-License-Identifier: MIT
# cmake -DPROGRAM=... -DTEMPLATE=... -DOUTPUT=... -DVERSION=... -P ManOptions.cmake
# Fills a manual page's @OPTIONS@ from the program's own table, so that the two cannot differ.
execute_process(COMMAND ${PROGRAM} --man-options OUTPUT_VARIABLE OPTIONS COMMAND_ERROR_IS_FATAL ANY)
string(STRIP "${OPTIONS}" OPTIONS)
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
