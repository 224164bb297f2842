# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Code from idl/*.idl, generated at build time into the build tree, never committed.
#   rtd_idl_fastdds(NAME IDL names...)  static library of the Fast DDS types of idl/<name>.idl, made as the installed package
#                                       rtd_msgs makes it for others. Headers are SYSTEM, warnings off.
set(rtd_msgs_IDL_DIR "${PROJECT_SOURCE_DIR}/idl")
include("${rtd_msgs_IDL_DIR}/rtd_msgs_library.cmake")

function(rtd_idl_fastdds name)
  rtd_msgs_library(${name} VENDOR fastdds ${ARGN})
  if(RTD_SANITIZE)
    target_compile_options(${name} PRIVATE -fsanitize=${RTD_SANITIZE})
  endif()
endfunction()
