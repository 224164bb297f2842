# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Sourced by the scripts beside it: points RTD_DATA_DIR and RTD_MODEL_DIR at ../shared when that folder exists.
# Data and weights are read in place and never copied into the project. The calling script sets $root.
# shellcheck shell=bash disable=SC2154
if [ -z "${RTD_DATA_DIR:-}" ] && [ -d "$root/../shared/data" ]; then
  RTD_DATA_DIR="$(cd "$root/../shared/data" && pwd)"
  export RTD_DATA_DIR
fi
if [ -z "${RTD_MODEL_DIR:-}" ] && [ -d "$root/../shared/models" ]; then
  RTD_MODEL_DIR="$(cd "$root/../shared/models" && pwd)"
  export RTD_MODEL_DIR
fi

# Configures and builds into build/release. $1: "ON" to build the tests too; the rest is passed to `cmake --build`.
build_release() {
  local tests="$1"
  shift
  mkdir -p "$root/build"
  cmake -S "$root" -B "$root/build/release" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRTD_BUILD_TESTS="$tests" \
    -DRTD_BUILD_BENCH="$tests" -DRTD_UNITY_BUILD=ON >"$root/build/configure.log" 2>&1 || {
    cat "$root/build/configure.log" >&2
    return 1
  }
  cmake --build "$root/build/release" "$@"
}
