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
Needs root and debootstrap; for arm64 on another machine qemu-user-static, and hours: deploy/cross.sh builds there with
the compiler of this machine and does the same with the packages.
Debian comes from where apt of this machine takes it.
TEXT
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
[ "$action" != package ] || try_packages "$work/user" "$place/root/rtd-slam/build/release/packages"
