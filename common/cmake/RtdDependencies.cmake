# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Finds every third-party package once. docs/dependencies.md explains why each is needed.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc features2d calib3d video dnn)
find_package(JPEG REQUIRED)
find_package(PNG REQUIRED)
find_package(TIFF REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tinyxml2 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(zstd REQUIRED)
find_package(OpenSSL REQUIRED)
find_library(RTD_DEFLATE_LIBRARY deflate REQUIRED)  # Debian's packages of these two have no CMake file
find_library(RTD_LZ4_LIBRARY lz4 REQUIRED)
find_package(BZip2 REQUIRED)
if(RTD_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d video dnn)  # imgcodecs: tests only
endif()
if(RTD_BUILD_BENCH)
  find_package(benchmark REQUIRED)
endif()
if(RTD_WITH_FASTDDS)
  # rtd_fastdds: Fast DDS 2 (Debian 12) or 3 (Debian 13), whichever is installed.
  find_package(fastcdr REQUIRED)
  find_package(fastrtps 2.9 QUIET)
  if(fastrtps_FOUND)
    set(fastdds_library fastrtps)
  else()
    find_package(fastdds 3.1 REQUIRED)
    set(fastdds_library fastdds)
  endif()
  add_library(rtd_fastdds INTERFACE)
  target_link_libraries(rtd_fastdds INTERFACE ${fastdds_library} fastcdr)
endif()
if(RTD_WITH_CYCLONEDDS)
  find_package(CycloneDDS 0.10 REQUIRED)
endif()

# What one service alone needs. Without it everything else is built, and the program that is asked for it names the
# package. The tests need those marked TESTED.
macro(rtd_optional name found what package)
  set(RTD_WITH_${name} AUTO CACHE STRING "Build ${what}: AUTO (if ${package} is installed), ON or OFF")
  if(RTD_WITH_${name} AND ${found})
    set(RTD_HAS_${name} ON)
  elseif(RTD_WITH_${name} AND NOT RTD_WITH_${name} STREQUAL "AUTO")
    message(FATAL_ERROR "RTD_WITH_${name} is ON, but its library was not found: install ${package}")
  elseif(RTD_BUILD_TESTS AND "${ARGN}" STREQUAL "TESTED")
    message(FATAL_ERROR "The tests need ${what}: install ${package}, or configure with -DRTD_BUILD_TESTS=OFF")
  elseif(RTD_WITH_${name})
    message(STATUS "Left out: ${what}; install ${package} and configure again")
  endif()
endmacro()

find_path(RTD_OPENNI2_INCLUDE_DIR openni2/OpenNI.h)
find_library(RTD_OPENNI2_LIBRARY OpenNI2)
rtd_optional(OPENNI2 RTD_OPENNI2_LIBRARY "OpenNI2 cameras" libopenni2-dev)
find_package(SQLite3 QUIET)
rtd_optional(SQLITE SQLite3_FOUND "reading of rosbag2's .db3 files" libsqlite3-dev TESTED)
find_package(octomap 1.9 QUIET)
rtd_optional(OCTOMAP octomap_FOUND "OctoMap files" liboctomap-dev TESTED)
find_path(RTD_BOOST_INCLUDE_DIR boost/beast/websocket.hpp)
find_path(RTD_THREE_DIR three.module.js PATHS /usr/share/javascript/three)
if(RTD_BOOST_INCLUDE_DIR AND RTD_THREE_DIR)
  set(viewer_found ON)
endif()
rtd_optional(VIEWER viewer_found "the viewer" "libboost-dev and libjs-three" TESTED)
# The ONNX Runtime engine of the detector needs only the C API's header: its library is named when the detector starts.
# deploy/setup.sh --onnxruntime fills build/onnxruntime.
set(RTD_ONNXRUNTIME_ROOT "" CACHE PATH "Folder of an unpacked ONNX Runtime")
set(onnxruntime_hints "${RTD_ONNXRUNTIME_ROOT}" "${PROJECT_SOURCE_DIR}/build/onnxruntime")
find_path(RTD_ONNXRUNTIME_INCLUDE_DIR onnxruntime_c_api.h HINTS ${onnxruntime_hints}
          PATH_SUFFIXES include onnxruntime onnxruntime/core/session)
find_library(RTD_ONNXRUNTIME_LIBRARY onnxruntime HINTS ${onnxruntime_hints} PATH_SUFFIXES lib)  # for the tests
rtd_optional(ONNXRUNTIME RTD_ONNXRUNTIME_INCLUDE_DIR "the detector's ONNX Runtime engine"
             "libonnxruntime-dev where there is one, or run deploy/setup.sh --onnxruntime, or set RTD_ONNXRUNTIME_ROOT,")
