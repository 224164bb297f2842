#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Does what a newcomer does, in README's words, on a system that was installed a minute ago: a chroot of its own, with
# its own processes, mounts and shared memory, of which nothing stays.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# shellcheck source=deploy/chroot.sh
. "$root/deploy/chroot.sh"

usage() {
  cat <<'TEXT'
Usage: deploy/try_on.sh bookworm|trixie[:arm64] [demo | test | package] [--keep FOLDER] [ARGUMENTS]
  demo           ./deploy/demo.sh (the default); ARGUMENTS are passed on
  test           ./deploy/test.sh; ARGUMENTS are passed on, e.g. -L unit
  package        ./deploy/package.sh, then the packages on another fresh system: first pose, upgrade, remove, purge
  --keep FOLDER  the system goes to this folder, which must not exist, and stays
Needs root and debootstrap; for arm64 on another machine qemu-user-static, and hours: deploy/cross.sh takes less.
Debian comes from where apt of this machine takes it.
TEXT
}

# The packages on a system that has never seen the sources.
try_packages() {
  local began user="$work/user"
  mount_system "$user"
  mkdir "$user/root/packages"
  cp "$1"/root/rtd-slam/build/release/packages/rtd-slam{,-viewer}_*.deb "$user/root/packages/"
  inside "$user" apt-get update -qq
  began=$SECONDS
  inside "$user" sh -c 'apt-get install -y -qq --no-install-recommends ./packages/*.deb >/dev/null'
  since "$began" "packages installed"
  inside "$user" rtd run --source 'synthetic:office?frames=30' --out /root/out --quiet
  [ "$(grep -c '^[0-9]' "$user/root/out/trajectory.txt")" -gt 20 ] || fail "30 frames gave too few poses"
  since "$began" "packages installed and 30 frames run"
  remove_packages "$user"
  since "$began" "packages installed, run, removed and purged"
  began=$SECONDS
  upgrade_packages "$user"
  remove_packages "$user"
  since "$began" "packages upgraded, removed and purged"
}

remove_packages() {
  local left
  inside "$1" sh -c 'apt-get remove -y -qq rtd-slam rtd-slam-viewer >/dev/null'
  [ -f "$1/etc/rtd-slam/rtd-slam.conf" ] || fail "remove took the settings away"
  inside "$1" sh -c 'apt-get purge -y -qq rtd-slam rtd-slam-viewer >/dev/null'
  left="$(cd "$1" && find etc usr var/lib/rtd-slam var/cache/rtd-slam -name '*rtd-slam*' 2>/dev/null || true)"
  [ -z "$left" ] || fail "purge left $left"
}

# From the same packages with a lower version; the user's settings stay.
upgrade_packages() {
  # shellcheck disable=SC2016 # variables of the inner shell, a field of dpkg-query
  inside "$1" sh -ec 'mkdir older
    for package in packages/*.deb; do
      version="$(dpkg-deb -f "$package" Version)"
      dpkg-deb -R "$package" unpacked
      sed -i "s/\b$version/0.0.1/" unpacked/DEBIAN/control
      dpkg-deb -Znone -b unpacked older >/dev/null
      rm -r unpacked
    done
    apt-get install -y -qq --no-install-recommends ./older/*.deb >/dev/null
    echo "# mine" >>/etc/rtd-slam/rtd-slam.conf
    apt-get install -y -qq --no-install-recommends ./packages/*.deb >/dev/null'
  [ "$(inside "$1" dpkg-query -W -f '${Version}' rtd-slam)" != 0.0.1 ] || fail "the packages were not upgraded"
  grep -q "^# mine" "$1/etc/rtd-slam/rtd-slam.conf" || fail "the upgrade took the user's settings away"
}

system="${1:-}"
case "$system" in
  --help | -h) usage && exit 0 ;;
  bookworm | trixie | bookworm:arm64 | trixie:arm64) ;;
  *) usage >&2 && exit 2 ;;
esac
require_chroot
own="$(dpkg --print-architecture)"
architecture="$own"
[ "${system%:*}" = "$system" ] || architecture="${system#*:}"
[ "$architecture" = "$own" ] || [ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] ||
  fail "this machine runs no programs for $architecture: apt-get install qemu-user-static binfmt-support" 2
in_namespace "$0" "$@"
shift

action=demo
case "${1:-}" in
  demo | test | package) action="$1" && shift ;;
esac
work="$(mktemp -d "${TMPDIR:-/var/tmp}/rtd-try.XXXXXX")"
trap unmount_systems EXIT
place="$work/system"
if [ "${1:-}" = --keep ]; then
  [ $# -gt 1 ] && [ ! -e "$2" ] || fail "--keep needs a folder that does not exist" 2
  place="$(realpath "$2")"
  shift 2
fi

install_system "$place" "${system%:*}" "$architecture"
[ "$action" != package ] || cp -a "$place" "$work/user"
copy_project "$place"
mount_system "$place"
began=$SECONDS
inside "$place" "./deploy/$action.sh" "$@"
since "$began" "./deploy/$action.sh"
[ "$action" != package ] || try_packages "$place"
