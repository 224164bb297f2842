#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Does what a newcomer does, in README's words, on a system that was installed a minute ago: its own chroot, with
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
Needs root and debootstrap. arm64 on amd64 runs under qemu, except for the compiler: that is the one of amd64 with the
same version.
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
[ "$architecture" = "$own" ] || [ "$own" = amd64 ] || fail "arm64 is tried on arm64 or amd64, not on $own" 2
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

[ "$architecture" = "$own" ] || emulate_arm64
install_system "$place" "${system%:*}" "$architecture"
[ "$action" != package ] || cp -a "$place" "$work/user"
copy_project "$place"
mount_system "$place"
[ "$architecture" = "$own" ] || lend_compiler "$place" "${system%:*}"
began=$SECONDS
inside "$place" "./deploy/$action.sh" "$@"
since "$began" "./deploy/$action.sh"
[ "$action" != package ] || try_packages "$work/user" "$place/root/rtd-slam/build/release/packages"
