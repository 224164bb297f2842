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
  RTD_IN_NAMESPACE=1 exec unshare --mount --propagation private --ipc --pid --fork --kill-child --mount-proc "$@"
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
  since "$began" "${1##*/} installed"
}

# On itself first: "ip netns exec" wants / to be a mount.
mount_system() {
  mount --bind "$1" "$1"
  mount -t proc proc "$1/proc"
  mount -t sysfs -o ro sysfs "$1/sys"
  mkdir -p "$1/dev/shm" "$1/dev/pts"
  mount -t tmpfs -o mode=1777 tmpfs "$1/dev/shm"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$1/dev/pts"
}

unmount_systems() {
  [ -z "${registered:-}" ] || echo -1 >"$registered"
  umount -R "$work"/* 2>/dev/null || true
  rm -rf --one-file-system "$work"
}

# install_tools RELEASE PACKAGE: a system of this machine's architecture in $work/tools-RELEASE, with the package.
install_tools() {
  local tools="$work/tools-$1"
  if [ ! -d "$tools" ]; then
    install_system "$tools" "$1" "$(dpkg --print-architecture)"
    mount_system "$tools"
  fi
  inside "$tools" sh -c 'apt-get install -y -qq --no-install-recommends "$1" >/dev/null' sh "$2"
}

# Programs for arm64 start by themselves, also those that a program starts, until the end of this script. With qemu of
# Debian 13 on any system: that of Debian 12 refuses multicast options, without which DDS finds no process.
emulate_arm64() {
  local entries=/proc/sys/fs/binfmt_misc entry=/proc/sys/fs/binfmt_misc/rtd-aarch64
  [ -e "$entries/register" ] || mount -t binfmt_misc binfmt_misc "$entries" || fail "this kernel has no binfmt_misc"
  [ ! -e "$entries/qemu-aarch64" ] || return 0
  [ ! -e "$entry" ] || fail "another run has registered its qemu; wait for it, or, if it was killed: echo -1 >$entry"
  install_tools trixie qemu-user
  mount -t binfmt_misc binfmt_misc "$work/tools-trixie$entries"
  inside "$work/tools-trixie" sh -c 'printf "%s" ":rtd-aarch64:M::\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00:\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff:/usr/bin/qemu-aarch64:F" >/proc/sys/fs/binfmt_misc/register'
  registered="$entry"
}

# lend_compiler FOLDER RELEASE: a system of arm64 compiles and links with programs of this machine, of the same version.
# Under qemu one compilation takes minutes; all else that it runs is its own.
lend_compiler() {
  local place="$1" program
  install_tools "$2" crossbuild-essential-arm64
  mkdir -p "$place/opt/compiler"
  mount --bind "$work/tools-$2/usr" "$place/opt/compiler"
  # Where those programs look for their loader and its libraries, and what the C library's linker script names.
  ln -s ../opt/compiler/lib64 "$place/usr/lib64"
  ln -s usr/lib64 "$place/lib64"
  ln -s ../../opt/compiler/lib/x86_64-linux-gnu "$place/usr/lib/x86_64-linux-gnu"
  ln -s ../opt/compiler/aarch64-linux-gnu "$place/usr/aarch64-linux-gnu"
  for program in gcc g++; do
    ln -s "/opt/compiler/bin/aarch64-linux-gnu-$program" "$place/usr/local/bin/$program"
  done
  ln -s gcc "$place/usr/local/bin/cc"
  ln -s g++ "$place/usr/local/bin/c++"
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

# try_packages SYSTEM FOLDER: the packages of FOLDER on a system that has never seen the sources.
try_packages() {
  local began user="$1"
  mount_system "$user"
  mkdir "$user/root/packages"
  cp "$2"/rtd-slam{,-viewer}_*.deb "$user/root/packages/"
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
