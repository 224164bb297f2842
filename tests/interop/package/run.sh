#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the package rtd_msgs, builds docs/examples from it alone and runs them against a living publisher and a recording.
#   run.sh BUILD_DIR EXAMPLES POSE_SOURCE RTD_RECORD VENDOR...     VENDOR: those that POSE_SOURCE has been built with
set -euo pipefail
build="$1" examples="$2" pose_source="$3" record="$4"
shift 4
work="$build/rtd_msgs_examples"
mkdir -p "$work/run"
trap 'kill $(jobs -p) 2>/dev/null || true; wait' EXIT

cmake --install "$build" --component rtd_msgs --prefix "$work/prefix" >"$work/install.log"
cmake -S "$examples" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" >"$work/configure.log"
cmake --build "$work/build" >"$work/build.log" || { cat "$work/build.log"; exit 1; }
grep -q "prefix/share/rtd_msgs" "$work/build/CMakeCache.txt" || { echo "another package rtd_msgs was found"; exit 1; }

# What an example prints is the pose that the source sends.
expect_poses() {
  local name="$1" output="$2" wanted="$3"
  [ "$(grep -cE '^[0-9]+\.[0-9]{9} map 1\.500 -2\.250 0\.125$' "$output")" -ge "$wanted" ] ||
    { echo "$name printed:"; head "$output"; exit 1; }
  echo "$name: $(wc -l <"$output") poses, the first $(head -1 "$output")"
}

on_loopback="<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General></Domain></CycloneDDS>"
export ROS_DOMAIN_ID=66
rm -f "$work/run/pose.mcap"
for vendor in "$@"; do
  "$pose_source" "$vendor" "$ROS_DOMAIN_ID" &
  source_pid=$!
  if [ "$vendor" = fastdds ]; then
    "$record" -o "$work/run/pose.mcap" --topics /slam/pose >"$work/run/record.log" 2>&1 &
    record_pid=$!
  fi
  for example in pose_cyclonedds pose_fastdds; do
    [ -x "$work/build/$example" ] || continue
    uri=""
    if [ "$vendor" = cyclonedds ]; then  # keeps to the loopback interface, where only those meet it who do too
      [ "$example" = pose_cyclonedds ] || continue
      uri="$on_loopback"
    fi
    CYCLONEDDS_URI="$uri" timeout 40 "$work/build/$example" 5 >"$work/run/$example.txt" ||
      { echo "$example got no pose from $vendor"; exit 1; }
    expect_poses "$example, $vendor" "$work/run/$example.txt" 5
  done
  if [ "$vendor" = fastdds ]; then
    kill -INT "$record_pid"
    wait "$record_pid" || [ $? -eq 3 ]  # 3: a message was lost on a busy host
  fi
  kill "$source_pid"
  wait "$source_pid" 2>/dev/null || true
done

if ! command -v node >/dev/null || [ ! -d "$build/viewers/node_modules/@mcap/core" ]; then
  echo "NOT RUN: pose_recording.mjs, node or its npm packages are not there; deploy/setup.sh --viewers installs them"
elif [ -f "$work/run/pose.mcap" ]; then
  cp "$examples/pose_recording.mjs" "$build/viewers/"  # beside node_modules, where imports are looked up
  node "$build/viewers/pose_recording.mjs" "$work/run/pose.mcap" >"$work/run/pose_recording.txt"
  expect_poses pose_recording.mjs "$work/run/pose_recording.txt" 1
fi
