# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# One place for how our targets are compiled and how tests are declared.
#   rtd_library(NAME [BRIEF] SOURCES... [PUBLIC libs...] [PRIVATE libs...])
#     Static library, includes from the repository root. BRIEF: works at the start, at the end or on demand, and for a
#     frame only a few calls, without a loop over pixels, points or bytes. Taken for granted of executables' own sources.
#   rtd_executable(NAME SOURCES... PRIVATE libs...)
#   rtd_test(NAME LABEL unit|component|interop|dataset SOURCES... LIBS... [TIMEOUT seconds] [SERIAL | PARALLEL | WAITS]
#            [NIGHTLY filter])
#     Tests labelled component and interop run alone unless PARALLEL, others in parallel (`ctest -j`) unless SERIAL.
#     NIGHTLY: checks by their names in googletest. LABEL.NAME.nightly runs them, and `deploy/test.sh` only with --all.
#     The targets rtd_unit_tests, rtd_component_tests and so on build all tests of a label.
#   rtd_test_part(LABEL.NAME PART filter [RUN_SERIAL ON | RESOURCE_LOCK processes | RESOURCE_LOCK runs])
#     LABEL.NAME.PART runs these checks of a program, with these properties instead of those of LABEL.NAME. The part
#     nightly has that label too.
#   rtd_bench(NAME SOURCES... LIBS...)
#     Built by the target rtd_benches only; `deploy/test.sh --all` builds it.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

add_library(rtd_compile_options INTERFACE)
target_include_directories(rtd_compile_options INTERFACE "${PROJECT_SOURCE_DIR}")
# -ffp-contract=off: the same source gives the same bits whether or not a loop is vectorised (lockstep runs are compared byte by byte).
target_compile_options(rtd_compile_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wno-missing-field-initializers
                       $<$<BOOL:${RTD_WERROR}>:-Werror> -ffp-contract=off)
# g++ 12 warns falsely of "literal" + std::string (GCC bug 105651).
target_compile_options(rtd_compile_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)

# On arm64 g++ notes of each std::pair<double, double> that old compilers passed it otherwise.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  target_compile_options(rtd_compile_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
endif()

# gold, which comes with binutils, links in a third of the time of the default linker.
include(CheckLinkerFlag)
check_linker_flag(CXX -fuse-ld=gold RTD_HAS_GOLD)
if(RTD_HAS_GOLD)
  target_link_options(rtd_compile_options INTERFACE -fuse-ld=gold)
endif()

# x86-64-v2 (SSE4.2, popcnt) runs on every x86 machine since 2009 and keeps Eigen's alignment that of Debian's libraries.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_compile_options(rtd_compile_options INTERFACE -march=x86-64-v2)
endif()

# Several sources of a target in one compilation: headers are parsed once, a clean build takes less than half of the time.
if(RTD_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 14)
  # Local types of one source look to g++ like types of a header once that source is included by another.
  target_compile_options(rtd_compile_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  # Tests share a precompiled header. ccache would not keep what includes one.
  if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(RTD_PRECOMPILE_TESTS ON)
  endif()
endif()

if(RTD_SANITIZE)
  target_compile_options(rtd_compile_options INTERFACE -fsanitize=${RTD_SANITIZE} -fno-omit-frame-pointer)
  # GCC warns of its own regular expressions once sanitizers are in (GCC bug 105562).
  target_compile_options(rtd_compile_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(rtd_compile_options INTERFACE -fsanitize=${RTD_SANITIZE})
  # They would double the time of the build. ASan reports what the first two find, x86-64 and ARMv8 load unaligned.
  if(RTD_SANITIZE MATCHES "undefined")
    target_compile_options(rtd_compile_options INTERFACE -fno-sanitize=null,object-size,alignment)
  endif()
endif()

function(rtd_common_target name)
  target_link_libraries(${name} PRIVATE rtd_compile_options)
  if(RTD_CLANG_TIDY)
    set_target_properties(${name} PROPERTIES CXX_CLANG_TIDY "clang-tidy;--quiet")
  endif()
endfunction()

# For what need not be fast: compiles in two thirds of the time.
function(rtd_compile_quickly name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

function(rtd_library name)
  cmake_parse_arguments(ARG "BRIEF" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  rtd_common_target(${name})
  if(ARG_BRIEF)
    rtd_compile_quickly(${name})
  endif()
endfunction()

# COMPONENT: of the installation, rtd_slam by default. INTERNAL: for developers, not installed.
function(rtd_executable name)
  cmake_parse_arguments(ARG "INTERNAL" "COMPONENT" "SOURCES;PRIVATE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE})
  rtd_common_target(${name})
  rtd_compile_quickly(${name})
  if(NOT ARG_INTERNAL)
    if(NOT ARG_COMPONENT)
      set(ARG_COMPONENT rtd_slam)
    endif()
    install(TARGETS ${name} RUNTIME DESTINATION bin COMPONENT ${ARG_COMPONENT})
    set_property(GLOBAL APPEND PROPERTY RTD_PROGRAMS_OF_${ARG_COMPONENT} ${name})
  endif()
endfunction()

function(rtd_test name)
  if(NOT RTD_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "SERIAL;PARALLEL;WAITS" "LABEL;NIGHTLY;TIMEOUT" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} rtd_test_main)
  rtd_common_target(${name})
  if(NOT TARGET rtd_${ARG_LABEL}_tests)
    add_custom_target(rtd_${ARG_LABEL}_tests)
  endif()
  add_dependencies(rtd_${ARG_LABEL}_tests ${name})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  # The checks themselves need not be fast, what they check keeps its optimisation.
  if(NOT ARG_LABEL STREQUAL "dataset")
    rtd_compile_quickly(${name})
    if(RTD_PRECOMPILE_TESTS)
      target_precompile_headers(${name} REUSE_FROM rtd_test_main)
    endif()
  endif()
  add_test(NAME ${ARG_LABEL}.${name} COMMAND ${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(RTD_SANITIZE)
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 5")
  elseif(CMAKE_CROSSCOMPILING)  # under emulation
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 10")
  endif()
  # 77: tests/support/test_main.cpp. COST: what may take long starts first, so that no core waits for it at the end.
  set_tests_properties(${ARG_LABEL}.${name} PROPERTIES LABELS ${ARG_LABEL} SKIP_RETURN_CODE 77
                       TIMEOUT ${ARG_TIMEOUT} COST ${ARG_TIMEOUT})
  # What keeps time, or loads all cores: not next to other tests. Of the other tests with several processes, which mostly
  # wait, one at a time, and one of those that are whole runs: these two rows of tests are the longest, so they start first.
  if(ARG_WAITS)
    set_tests_properties(${ARG_LABEL}.${name} PROPERTIES RESOURCE_LOCK processes COST 10000)
  elseif(ARG_SERIAL OR (NOT ARG_PARALLEL AND ARG_LABEL MATCHES "^(component|interop)$"))
    set_tests_properties(${ARG_LABEL}.${name} PROPERTIES RUN_SERIAL ON)
  endif()
  if(ARG_NIGHTLY)
    rtd_test_part(${ARG_LABEL}.${name} nightly "${ARG_NIGHTLY}")
  endif()
endfunction()

function(rtd_test_part test part filter)
  get_test_property(${test} RTD_PARTS parts)
  if(NOT parts)
    set(parts "")
  endif()
  string(REGEX REPLACE "-.*" "" all_of_part "${filter}")
  list(APPEND parts "${all_of_part}")
  list(JOIN parts ":" others)
  string(REGEX REPLACE "^[a-z]+\\." "" program ${test})
  add_test(NAME ${test}.${part} COMMAND ${program})
  foreach(property LABELS SKIP_RETURN_CODE TIMEOUT COST RESOURCE_LOCK RUN_SERIAL)
    get_test_property(${test} ${property} value)
    if(value)
      set_property(TEST ${test}.${part} PROPERTY ${property} ${value})
    endif()
  endforeach()
  if(part STREQUAL "nightly")
    set_property(TEST ${test}.${part} APPEND PROPERTY LABELS nightly)
  endif()
  set_tests_properties(${test}.${part} PROPERTIES ENVIRONMENT_MODIFICATION "GTEST_FILTER=set:${filter}" ${ARGN})
  if("RESOURCE_LOCK" IN_LIST ARGN)
    set_tests_properties(${test}.${part} PROPERTIES COST 10000)
  endif()
  set_tests_properties(${test} PROPERTIES RTD_PARTS "${parts}" ENVIRONMENT_MODIFICATION "GTEST_FILTER=set:-${others}")
endfunction()

function(rtd_bench name)
  if(NOT RTD_BUILD_BENCH)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} benchmark::benchmark)
  rtd_common_target(${name})
  if(NOT TARGET rtd_benches)
    add_custom_target(rtd_benches)
  endif()
  add_dependencies(rtd_benches ${name})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bench")
endfunction()
