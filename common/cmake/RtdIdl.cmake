# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Code from idl/*.idl, generated at build time into the build tree, never committed.
#   rtd_idl_fastdds(NAME IDL names...)  static library of the Fast DDS types of idl/<name>.idl; one fastddsgen run for all
#                                       (the JVM start costs more than the work). Headers are SYSTEM, warnings off.

function(rtd_idl_fastdds name)
  cmake_parse_arguments(ARG "" "" "IDL" ${ARGN})
  find_program(RTD_FASTDDSGEN fastddsgen)
  find_program(RTD_JAVA java HINTS "$ENV{JAVA_HOME}/bin")
  if(NOT RTD_FASTDDSGEN OR NOT RTD_JAVA)
    message(FATAL_ERROR "fastddsgen and a Java runtime are needed to build the Fast DDS backend: "
                        "apt-get install fastddsgen default-jre-headless, or configure with -DRTD_WITH_FASTDDS=OFF")
  endif()
  set(idl_dir "${PROJECT_SOURCE_DIR}/idl")
  set(out_dir "${CMAKE_BINARY_DIR}/generated/${name}")
  set(idl_files ${ARG_IDL})
  list(TRANSFORM idl_files PREPEND "${idl_dir}/")
  list(TRANSFORM idl_files APPEND ".idl")
  set(sources)
  set(headers)
  foreach(idl IN LISTS ARG_IDL)
    list(APPEND sources "${out_dir}/${idl}.cxx" "${out_dir}/${idl}PubSubTypes.cxx")
    list(APPEND headers "${out_dir}/${idl}.h" "${out_dir}/${idl}PubSubTypes.h")
  endforeach()
  # fastddsgen ends with 0 after some errors; a missing output then fails the build. -typeros2 is left out on purpose: the
  # ROS 2 names stand in the IDL already and would be mangled twice. -t: two builds at once would share files in /tmp otherwise.
  add_custom_command(
    OUTPUT ${sources} ${headers}
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${out_dir}"
    COMMAND "${RTD_FASTDDSGEN}" -cs -replace -t "${out_dir}" -d "${out_dir}" -I "${idl_dir}" ${idl_files}
    DEPENDS ${idl_files}
    WORKING_DIRECTORY "${idl_dir}"
    COMMENT "Generating Fast DDS types from idl/"
    VERBATIM)
  add_library(${name} STATIC ${sources} ${headers})
  target_include_directories(${name} SYSTEM PUBLIC "${out_dir}")
  target_compile_options(${name} PRIVATE -w)
  if(RTD_SANITIZE)
    target_compile_options(${name} PRIVATE -fsanitize=${RTD_SANITIZE})
  endif()
  target_link_libraries(${name} PUBLIC fastrtps fastcdr)
endfunction()
