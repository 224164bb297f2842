#!/bin/bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# check_packages.sh BUILD_FOLDER: makes the Debian packages, installs, uses, upgrades, removes and purges them in a copy
# of this system that only this test sees (overlay file system in a mount namespace), with lintian where it is installed.
# Exit code 77 = skipped.
set -eu
build="$1"
[ "$(id -u)" -eq 0 ] || { echo "SKIPPED: needs root for a copy of the file system"; exit 77; }
for tool in cpack dpkg-deb unshare chroot systemd-sysusers; do
  command -v "$tool" >/dev/null || { echo "SKIPPED: $tool is not installed"; exit 77; }
done
if [ "${RTD_IN_NAMESPACE:-}" = "" ]; then
  unshare -m true 2>/dev/null || { echo "SKIPPED: this kernel gives no mount namespace here"; exit 77; }
  RTD_IN_NAMESPACE=1 exec unshare -m --propagation private "$0" "$@"
fi

work="$(mktemp -d)"
mount -t tmpfs tmpfs "$work"
trap 'umount -l "$work"; rmdir "$work"' EXIT
fail() {
  echo "FAILED: $1"
  exit 1
}

make_packages() { # VERSION FOLDER
  cpack --config "$build/CPackConfig.cmake" -G DEB -B "$2" -D CPACK_PACKAGE_VERSION="$1" \
    -D CPACK_DEBIAN_RTD_VIEWER_PACKAGE_DEPENDS="rtd-slam (= $1), libjs-three" >"$work/cpack.log" 2>&1 ||
    fail "cpack: $(tail -5 "$work/cpack.log")"
  rm -rf "$2/_CPack_Packages"
}
holds() { # PACKAGE FILE...
  local package="$1" file list
  shift
  list="$(dpkg-deb -c "$work"/1/"${package}"_*.deb)"
  for file in "$@"; do
    grep -q " \./$file\$" <<<"$list" || fail "$package lacks $file"
  done
}

version="$(sed -n 's/^set(CPACK_PACKAGE_VERSION "\(.*\)")$/\1/p' "$build/CPackConfig.cmake")"
[ -n "$version" ] || fail "$build/CPackConfig.cmake names no version: is it a build folder?"
. /etc/os-release
[[ "$version" = *"+${ID:0:3}$VERSION_ID" ]] || fail "version $version does not name this distribution"
make_packages "$version" "$work/1"
holds rtd-slam usr/bin/rtd usr/bin/rtd-slam usr/bin/rtd-link usr/bin/rtd-atlas usr/lib/systemd/system/rtd-slam@.service \
  usr/lib/systemd/system/rtd-slam@camera.service.d/devices.conf usr/lib/sysusers.d/rtd-slam.conf \
  usr/lib/udev/rules.d/60-rtd-cameras.rules etc/rtd-slam/rtd-slam.conf usr/share/doc/rtd-slam/copyright
holds rtd-slam-viewer usr/bin/rtd-viewer
holds rtd-msgs-dev usr/share/rtd_msgs/idl/rtd_msgs.idl usr/share/rtd_msgs/cmake/rtd_msgsConfig.cmake
holds python3-rtd-slam usr/lib/python3/dist-packages/rtd_slam/__init__.py
holds rtd-slam-doc usr/share/doc/rtd-slam-doc/docs/operations.md usr/share/doc/rtd-slam-doc/services/slam/README.md
for package in "$work"/1/*.deb; do
  dpkg-deb -c "$package" | grep -E "usr/local|/s?bin/.*(bench|train)|test_" && fail "$package holds what it should not"
done
# Without help2man this build has no manual pages, which lintian would miss.
if command -v lintian >/dev/null && grep -q '^RTD_HELP2MAN:FILEPATH=/' "$build/CMakeCache.txt"; then
  lintian --allow-root --fail-on error,warning "$work"/1/*.deb || fail "lintian"
fi

mkdir "$work/upper" "$work/scratch" "$work/root"
mount -t overlay overlay -o "lowerdir=/,upperdir=$work/upper,workdir=$work/scratch" "$work/root" 2>/dev/null ||
  { echo "SKIPPED: this kernel gives no overlay file system here"; exit 77; }
mount -t proc proc "$work/root/proc"
mount -t tmpfs -o mode=1777 tmpfs "$work/root/dev/shm"
mount -t tmpfs tmpfs "$work/root/run"
mkdir "$work/root/packages"
inside() { chroot "$work/root" env -u RTD_MODEL_DIR -u RTD_DATA_DIR HOME=/nonexistent DEBIAN_FRONTEND=noninteractive "$@"; }
holdings() { (cd "$work/upper" && find . \( -ipath '*rtd*' \) -not -path './packages*' -not -path './var/lib/dpkg/*' \
  -not -path './var/cache/man/*' -not -path './tmp/*' | sort); }

cp "$work"/1/*.deb "$work/root/packages/"
inside sh -c 'dpkg -i /packages/*.deb' >"$work/dpkg.log" 2>&1 || fail "installation: $(cat "$work/dpkg.log")"
inside getent passwd rtd-slam >/dev/null || fail "no account rtd-slam"
inside rtd version | grep -q . || fail "rtd does not run"
inside sh -c 'cd /tmp && rtd run --source "synthetic:office?frames=40" --out /tmp/run --domain 77 --quiet --detector off' \
  >"$work/run.log" 2>&1 || fail "rtd run: $(cat "$work/run.log")"
[ "$(inside grep -c '^[0-9]' /tmp/run/trajectory.txt)" -gt 30 ] || fail "poses of 40 frames: $(cat "$work/run.log")"
inside systemd-analyze verify /usr/lib/systemd/system/rtd-slam@slam.service 2>&1 | grep rtd-slam && fail "unit of slam"
inside /usr/bin/python3 -c "import rtd_slam; assert len(rtd_slam.open('/tmp/run').poses) > 30" || fail "python3-rtd-slam"
inside rtd-viewer --help >/dev/null || fail "rtd-viewer does not run"

echo "RTD_COMMON_OPTIONS=--profile lan" >"$work/root/etc/rtd-slam/rtd-slam.conf"
echo "kept" >"$work/root/etc/rtd-slam/camera.conf"
mkdir -p "$work/root/var/lib/rtd-slam" && echo map >"$work/root/var/lib/rtd-slam/room.rtdmap"
make_packages "$version.1" "$work/2"
rm "$work"/root/packages/*.deb && cp "$work"/2/*.deb "$work/root/packages/"
inside sh -c 'dpkg -i --force-confold /packages/*.deb' >"$work/dpkg.log" 2>&1 || fail "upgrade: $(cat "$work/dpkg.log")"
[ "$(inside dpkg-query -W -f '${Version}' rtd-slam)" = "$version.1" ] || fail "not upgraded"
grep -q lan "$work/root/etc/rtd-slam/rtd-slam.conf" || fail "the upgrade replaced settings"

inside dpkg --remove rtd-slam-viewer rtd-slam rtd-msgs-dev python3-rtd-slam rtd-slam-doc >"$work/dpkg.log" 2>&1 ||
  fail "removal: $(cat "$work/dpkg.log")"
[ -f "$work/root/var/lib/rtd-slam/room.rtdmap" ] || fail "removal took the map"
inside dpkg --purge rtd-slam-viewer rtd-slam rtd-msgs-dev python3-rtd-slam rtd-slam-doc >"$work/dpkg.log" 2>&1 ||
  fail "purge: $(cat "$work/dpkg.log")"
# What is deleted of a lower layer is a character device.
left="$(holdings | while read -r path; do [ -c "$work/upper/$path" ] || echo "$path"; done)"
[ -z "$left" ] || fail "left after purge: $left"
echo "installed, used, upgraded, removed and purged"
