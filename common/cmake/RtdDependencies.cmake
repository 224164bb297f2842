# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Every third-party package, found once. docs/dependencies.md says why each is here.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d video dnn)
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
endif()
if(RTD_BUILD_BENCH)
  find_package(benchmark REQUIRED)
endif()
if(RTD_WITH_CYCLONEDDS)
  find_package(CycloneDDS 0.10 REQUIRED)  # found here, because tests use its idlc_generate() too
endif()
