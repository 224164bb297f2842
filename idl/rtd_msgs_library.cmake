# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
#   rtd_msgs_library(NAME VENDOR cyclonedds|fastdds [IDL names...])
# A static library of the types of rtd_msgs_IDL_DIR/<name>.idl and all that they include (default: all files) as the
# vendor's own tool generates them. Its headers: <name>.h, for Fast DDS also <name>PubSubTypes.h. Both vendors call them
# alike, so no source file can include those of both.

# The names with those that they include, which come first.
function(_rtd_msgs_closure names result)
  set(all)
  foreach(name IN LISTS names)
    set(file "${rtd_msgs_IDL_DIR}/${name}.idl")
    if(NOT EXISTS "${file}")
      message(FATAL_ERROR "rtd_msgs_library: no IDL file '${name}', known: ${rtd_msgs_IDL}")
    endif()
    file(STRINGS "${file}" includes REGEX "^#include")
    list(TRANSFORM includes REPLACE "^#include \"(.*)\\.idl\".*" "\\1")
    _rtd_msgs_closure("${includes}" included)
    list(APPEND all ${included} ${name})
  endforeach()
  list(REMOVE_DUPLICATES all)
  set(${result} "${all}" PARENT_SCOPE)
endfunction()

# idlc, once a file.
function(_rtd_msgs_cyclonedds out_dir names result)
  find_program(RTD_IDLC idlc)
  if(NOT RTD_IDLC)
    message(FATAL_ERROR "types for Cyclone DDS need idlc: apt-get install cyclonedds-tools")
  endif()
  set(sources)
  foreach(name IN LISTS names)
    set(idl "${rtd_msgs_IDL_DIR}/${name}.idl")
    add_custom_command(
      OUTPUT "${out_dir}/${name}.c" "${out_dir}/${name}.h"
      COMMAND "${CMAKE_COMMAND}" -E make_directory "${out_dir}"
      COMMAND "${RTD_IDLC}" -I "${rtd_msgs_IDL_DIR}" -o "${out_dir}" "${idl}"
      DEPENDS "${idl}"
      VERBATIM)
    list(APPEND sources "${out_dir}/${name}.c" "${out_dir}/${name}.h")
  endforeach()
  set(${result} "${sources}" PARENT_SCOPE)
endfunction()

# One run of fastddsgen for all: the JVM's start costs more than the work. It ends with 0 after some errors; a missing
# output then fails the build. -typeros2 is left out on purpose: the ROS 2 names stand in the IDL already and would be
# mangled twice. -t: two builds at once would share files in /tmp otherwise.
function(_rtd_msgs_fastdds out_dir names result)
  find_program(RTD_FASTDDSGEN fastddsgen)
  find_program(RTD_JAVA java HINTS "$ENV{JAVA_HOME}/bin")
  if(NOT RTD_FASTDDSGEN OR NOT RTD_JAVA)
    message(FATAL_ERROR "types for Fast DDS need fastddsgen and a Java runtime: apt-get install fastddsgen default-jre-headless")
  endif()
  set(sources)
  set(idl_files)
  foreach(name IN LISTS names)
    list(APPEND idl_files "${rtd_msgs_IDL_DIR}/${name}.idl")
    list(APPEND sources "${out_dir}/${name}.cxx" "${out_dir}/${name}PubSubTypes.cxx" "${out_dir}/${name}.h"
         "${out_dir}/${name}PubSubTypes.h")
  endforeach()
  add_custom_command(
    OUTPUT ${sources}
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${out_dir}"
    COMMAND "${RTD_FASTDDSGEN}" -cs -replace -t "${out_dir}" -d "${out_dir}" -I "${rtd_msgs_IDL_DIR}" ${idl_files}
    DEPENDS ${idl_files}
    WORKING_DIRECTORY "${rtd_msgs_IDL_DIR}"
    COMMENT "Generating Fast DDS types"
    VERBATIM)
  set(${result} "${sources}" PARENT_SCOPE)
endfunction()

function(rtd_msgs_library name)
  cmake_parse_arguments(ARG "" "VENDOR" "IDL" ${ARGN})
  if(NOT ARG_IDL)
    set(ARG_IDL "${rtd_msgs_IDL}")
  endif()
  set(out_dir "${CMAKE_BINARY_DIR}/generated/${name}")
  _rtd_msgs_closure("${ARG_IDL}" names)
  if(ARG_VENDOR STREQUAL "cyclonedds")
    _rtd_msgs_cyclonedds("${out_dir}" "${names}" sources)
    set(libraries CycloneDDS::ddsc)
  elseif(ARG_VENDOR STREQUAL "fastdds")
    _rtd_msgs_fastdds("${out_dir}" "${names}" sources)
    set(libraries fastrtps fastcdr)
  else()
    message(FATAL_ERROR "rtd_msgs_library(${name}): VENDOR is '${ARG_VENDOR}', known: cyclonedds, fastdds")
  endif()
  add_library(${name} STATIC ${sources})
  target_include_directories(${name} SYSTEM PUBLIC "${out_dir}")
  target_compile_options(${name} PRIVATE -w)
  target_link_libraries(${name} PUBLIC ${libraries})
endfunction()
