# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Sourced by try_on.sh and cross.sh: freshly installed systems in folders, of which no mount and no process stays. The
# calling script sets $root, $system (for messages) and $work, a scratch folder.
# shellcheck shell=bash disable=SC2154

fail() {
  echo "${0##*/}: $1" >&2
  exit "${2:-1}"
}

# since SECONDS_AT_START WHAT
since() {
  echo "${0##*/}: $system: $2: $((SECONDS - $1)) s"
}

require_chroot() {
  [ "$(id -u)" -eq 0 ] || fail "a chroot needs root; run this as root or with sudo" 2
  command -v debootstrap >/dev/null || fail "debootstrap is missing: apt-get install debootstrap" 2
}

# in_namespace SCRIPT ARGUMENTS...: the script again, where all its processes and mounts end with it.
in_namespace() {
  [ -z "${RTD_IN_NAMESPACE:-}" ] || return 0
  RTD_IN_NAMESPACE=1 exec unshare --mount --propagation private --pid --fork --kill-child --mount-proc "$@"
}

# The place that apt of this machine takes Debian from.
mirror() {
  # shellcheck disable=SC2016 # apt's own variables
  apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' 2>/dev/null | head -1
}

# install_system FOLDER RELEASE ARCHITECTURE
install_system() {
  local began=$SECONDS from
  from="$(mirror)"
  [ -n "$from" ] || fail "apt of this machine knows no place of Debian: run apt-get update"
  debootstrap --variant=minbase --arch="$3" "$2" "$1" "$from" >"$work/debootstrap.log" 2>&1 || {
    tail -5 "$work/debootstrap.log" >&2
    fail "debootstrap failed"
  }
  cp /etc/resolv.conf "$1/etc/resolv.conf"
  echo force-unsafe-io >"$1/etc/dpkg/dpkg.cfg.d/rtd" # it is thrown away: no waiting for the disk
  since "$began" "system installed"
}

mount_system() {
  mount -t proc proc "$1/proc"
  mount -t sysfs -o ro sysfs "$1/sys"
  mkdir -p "$1/dev/shm" "$1/dev/pts"
  mount -t tmpfs -o mode=1777 tmpfs "$1/dev/shm"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$1/dev/pts"
}

unmount_systems() {
  umount -R "$work"/*/dev/shm "$work"/*/dev/pts "$work"/*/proc "$work"/*/sys 2>/dev/null || true
  rm -rf --one-file-system "$work"
}

# inside FOLDER COMMAND...: in the folder of the project, where there is one. RTD_INSIDE: more variables.
inside() {
  local folder="$1"
  shift
  # shellcheck disable=SC2086 # several variables
  chroot "$folder" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive ${RTD_INSIDE:-} \
    sh -c 'cd /root/rtd-slam 2>/dev/null || cd /root; exec "$@"' sh "$@"
}

# What git would give a newcomer, with the changes made here.
copy_project() {
  mkdir -p "$1/root/rtd-slam"
  git -c safe.directory="$root" -C "$root" ls-files -z --cached --others --exclude-standard --deduplicate |
    (cd "$root" && xargs -0 -r sh -c 'for f; do [ ! -f "$f" ] || printf "%s\0" "$f"; done' sh) |
    tar -C "$root" --null -T - -c | tar -C "$1/root/rtd-slam" --no-same-owner -x
}
