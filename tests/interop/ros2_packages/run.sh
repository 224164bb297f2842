#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds the packages for ROS 2 with Debian's ament and rosidl, as colcon does, and compares the generated structs.
#   run.sh SOURCE_DIR WORK_DIR
set -euo pipefail
source_dir="$1"
work="$2"
python=/usr/bin/python3  # that of Debian, which has the modules of ament

for part in ament_cmake rosidl_cmake rosidl_generator_cpp; do
  if [ ! -d "/usr/share/$part/cmake" ]; then
    echo "skipped: $part is not installed: deploy/setup.sh installs ament-cmake, rosidl-cmake, rosidl-generator-c-cpp"
    exit 77
  fi
done
rm -rf "$work"
mkdir -p "$work"
build() {
  cmake -S "$1" -B "$work/build/$2" -DCMAKE_INSTALL_PREFIX="$work/install" -DPython3_EXECUTABLE="$python" \
    -DBUILD_TESTING=OFF >"$work/$2.log" 2>&1 &&
    cmake --build "$work/build/$2" >>"$work/$2.log" 2>&1 &&
    cmake --install "$work/build/$2" >>"$work/$2.log" 2>&1 || { tail -40 "$work/$2.log"; exit 1; }
}
build "$source_dir/idl/ros2/rtd_msgs" rtd_msgs
build "$source_dir/deploy/ros2/rtd_slam_launch" rtd_slam_launch

index="$work/install/share/ament_index/resource_index"
for package in rtd_msgs rtd_slam_launch; do
  test -f "$index/packages/$package" || { echo "$package is not in the index of packages"; exit 1; }
done
# Every .msg and .srv of the sources is a type of the package.
listed="$(grep -cE '^(msg|srv)/[A-Za-z0-9]+\.(msg|srv)$' "$index/rosidl_interfaces/rtd_msgs")"
sources="$(find "$source_dir/idl/ros2/rtd_msgs" -name '*.msg' -o -name '*.srv' | wc -l)"
[ "$listed" -eq "$sources" ] || { echo "$listed of $sources types are in the package"; exit 1; }
share="$work/install/share/rtd_slam_launch"
for file in launch/rtd_slam.launch.py launch/realsense.launch.xml config/nav2.yaml rviz/rtd_slam.rviz; do
  test -f "$share/$file" || { echo "$file is not installed"; exit 1; }
done
g++ -std=c++20 -fsyntax-only -I "$source_dir" -I "$work/install/include/rtd_msgs" \
  -I /usr/include/rosidl_runtime_c -I /usr/include/rosidl_typesupport_interface -I /usr/include/rcutils \
  "$source_dir/tests/interop/ros2_packages/layout.cpp"
echo "2 packages, $listed types; the plain ones have the layout of common/msg"
