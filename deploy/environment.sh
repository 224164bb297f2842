# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Sourced by the scripts next to it: points RTD_DATA_DIR and RTD_MODEL_DIR at ../shared when that folder exists.
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
# RTD_WERROR=ON makes warnings errors.
build_release() {
  local tests="$1"
  shift
  mkdir -p "$root/build"
  cmake -S "$root" -B "$root/build/release" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRTD_BUILD_TESTS="$tests" \
    -DRTD_BUILD_BENCH="$tests" -DRTD_UNITY_BUILD=ON -DRTD_WERROR="${RTD_WERROR:-OFF}" >"$root/build/configure.log" 2>&1 || {
    cat "$root/build/configure.log" >&2
    return 1
  }
  local began=$SECONDS
  cmake --build "$root/build/release" --parallel "$(compilers_at_once)" "$@" | show_progress
  echo "$(basename "$0" .sh): built in $((SECONDS - began)) s"
}

# As many as there are cores, fewer where memory is short: each takes up to 1.3 GB.
compilers_at_once() {
  awk -v cores="$(nproc)" '/^MemAvailable/ { fit = int($2 / 1.3e6); print fit < 1 ? 1 : (fit < cores ? fit : cores) }' \
    /proc/meminfo
}

# Passes on what ninja prints, but for its steps: of these it says how many are done and how long the rest will take, by
# the pace of those so far. The first ones are the slowest, so that pace is mixed with that of a whole build, six
# seconds of a core a step, as if a sixth of the steps had been built so before.
show_progress() {
  local began=$SECONDS next=$((SECONDS + 15)) cores line seconds before
  cores="$(nproc)"
  while IFS= read -r line; do
    if ! [[ "$line" =~ ^\[([0-9]+)/([0-9]+)\] ]]; then
      printf '%s\n' "$line"
    elif [ "$SECONDS" -ge "$next" ] && [ "${BASH_REMATCH[1]}" -ge 10 ]; then
      next=$((SECONDS + 15))
      before=$((BASH_REMATCH[2] / 6))
      seconds=$(((6 * before / cores + SECONDS - began) * (BASH_REMATCH[2] - BASH_REMATCH[1]) /
        (before + BASH_REMATCH[1])))
      echo "$(basename "$0" .sh): ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]} steps built, about" \
        "$((seconds / 60)) min $((seconds % 60)) s to go"
    fi
  done
}
