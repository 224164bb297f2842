#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds for arm64 on another machine, in a chroot with Debian's cross compiler and arm64 packages, and runs the tests
# with qemu's emulation of single programs.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# shellcheck source=deploy/chroot.sh
. "$root/deploy/chroot.sh"
# shellcheck source=deploy/environment.sh
. "$root/deploy/environment.sh"

usage() {
  cat <<'TEXT'
Usage: deploy/cross.sh bookworm|trixie [--keep FOLDER] [build [TARGET...] | test [CTEST ARGUMENTS] | package]
  build          builds the targets (default: all) for arm64
  test           builds what the tests need, runs them under qemu (without -L: -L unit), then one clip in lockstep
  package        builds the Debian packages, then tries them on a fresh system of arm64 under qemu: first pose,
                 upgrade, remove, purge
  --keep FOLDER  the system with its build is in this folder: made where there is none, and kept
Needs root and debootstrap. Without a command: test.
TEXT
}

# The packages of setup.sh: libraries for arm64, programs for this machine, and node for arm64, which tests the page.
# OpenCV for Python is not to be had with the libraries of arm64: what needs it is skipped.
packages_for() {
  local package
  inside "$place" ./deploy/setup.sh --list | grep -vE '^(build-essential|python3-(opencv|rosbag|sensor-msgs)|nftables|iproute2|fastdds-tools)' |
    while read -r package; do
      if [[ "$package" == *-dev ]] &&
        ! inside "$place" apt-cache show --no-all-versions "$package" | grep -q '^Architecture: all$'; then
        package="$package:arm64"
      fi
      echo "$package"
    done
}

install_cross() {
  local began=$SECONDS
  mapfile -t packages < <(
    inside "$place" dpkg --add-architecture arm64
    inside "$place" apt-get update -qq
    packages_for
  )
  inside "$place" apt-get install -y -qq --no-install-recommends crossbuild-essential-arm64 ccache \
    python3-minimal dpkg-dev file nodejs:arm64 "${packages[@]}" >"$work/apt.log" 2>&1 || {
    tail -5 "$work/apt.log" >&2
    fail "the packages could not be installed"
  }
  touch "$place/root/installed"
  since "$began" "cross compiler and packages installed"
}

build() {
  local began=$SECONDS
  inside "$place" cmake -S . -B build/arm64 -G Ninja -DCMAKE_TOOLCHAIN_FILE=deploy/arm64.cmake \
    -DCMAKE_BUILD_TYPE=Release -DRTD_BUILD_TESTS=ON -DRTD_BUILD_BENCH=OFF -DRTD_UNITY_BUILD=ON \
    -DCMAKE_CXX_COMPILER_LAUNCHER=ccache >"$work/configure.log" 2>&1 || {
    tail -20 "$work/configure.log" >&2
    fail "cmake failed"
  }
  inside "$place" cmake --build build/arm64 --parallel "$(compilers_at_once)" ${1:+--target "$@"} | show_progress
  since "$began" "built for arm64"
}

# A rendered scene here, where the product is built here, and under qemu: the same poses within a micrometre.
lockstep() {
  local began=$SECONDS run=(run --source 'synthetic:crowd?frames=40' --pace lockstep --detector off --quiet --out)
  rm -rf "$place/root/clip"
  "$root/build/release/bin/rtd" "${run[@]}" "$work/clip" || return 1
  inside "$place" build/arm64/bin/rtd "${run[@]}" /root/clip || return 1
  since "$began" "40 frames in lockstep here and under qemu"
  paste -d ' ' "$work/clip/trajectory.txt" "$place/root/clip/trajectory.txt" | awk -v name="${0##*/}" '
    /^#/ { next }
    NF != 16 || $1 != $9 { print name ": other frames have poses"; failed = 1; exit 1 }
    { poses++; for (i = 2; i <= 4; i++) { off = $i - $(i + 8); if (off < 0) off = -off; if (off > most) most = off } }
    END { if (failed || !poses) exit 1
          printf "%s: %d poses, at most %.9f m apart\n", name, poses, most; exit most > 1e-6 }'
}

run_tests() {
  local began status=0
  [ -x "$root/build/release/bin/rtd-slam" ] ||
    fail "build here first, so that there are poses to compare with: ./deploy/package.sh"
  case " $* " in
    *" -L "*) build ;;
    *)
      set -- -L unit "$@"
      build rtd_services rtd_unit_tests
      ;;
  esac
  began=$SECONDS
  emulate_arm64
  inside "$place" ctest --test-dir build/arm64 -j "$(nproc)" --timeout 1200 --output-on-failure "$@" || status=$?
  since "$began" "tests under qemu"
  lockstep || status=1
  return "$status"
}

system="${1:-}"
case "$system" in
  --help | -h) usage && exit 0 ;;
  bookworm | trixie) ;;
  *) usage >&2 && exit 2 ;;
esac
require_chroot
in_namespace "$0" "$@"
shift
work="$(mktemp -d "${TMPDIR:-/var/tmp}/rtd-cross.XXXXXX")"
trap unmount_systems EXIT
place="$work/system"
if [ "${1:-}" = --keep ]; then
  [ $# -gt 1 ] || fail "--keep needs a folder" 2
  place="$(realpath "$2")"
  shift 2
fi
[ -e "$place/etc/debian_version" ] || install_system "$place" "$system" "$(dpkg --print-architecture)"
copy_project "$place"
mount_system "$place"
[ -e "$place/root/installed" ] || install_cross
command="${1:-test}"
[ $# -eq 0 ] || shift
case "$command" in
  build) build "$@" ;;
  test) run_tests "$@" ;;
  package)
    build rtd_packages
    inside "$place" sh -c 'cd build/arm64 && cpack -G DEB >cpack.log 2>&1 || { tail -20 cpack.log >&2; exit 1; }'
    ls -l "$place"/root/rtd-slam/build/arm64/packages/*.deb
    emulate_arm64
    install_system "$work/user" "$system" arm64
    try_packages "$work/user" "$place/root/rtd-slam/build/arm64/packages"
    ;;
  *) usage >&2 && exit 2 ;;
esac
