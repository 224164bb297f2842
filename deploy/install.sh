#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs RTD-SLAM on this computer from its Debian packages, with the detector's weights, ready to start at boot.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

usage() {
  cat <<'TEXT'
Usage: deploy/install.sh [--packages FOLDER] [--source CAMERA] [--no-models] [--no-viewer] | --remove | --purge
  (none)             installs rtd-slam, rtd-slam-viewer and the detector's weights
  --packages FOLDER  where the .deb files are (default: build/release/packages, built if there are none)
  --source CAMERA    also starts camera, detector, filter and slam now and at each boot, e.g. --source openni2:
  --no-models        without weights: geometry only
  --no-viewer        without rtd-slam-viewer
  --remove           removes the packages; settings and maps stay
  --purge            removes the packages, settings, maps and caches
TEXT
}

fail() {
  echo "install: $1" >&2
  exit "${2:-1}"
}

packages="" source="" action=install models=1 viewer=1
while [ $# -gt 0 ]; do
  case "$1" in
    --packages | --source)
      [ $# -gt 1 ] || fail "$1 needs a value; see deploy/install.sh --help" 2
      declare "${1#--}=$2"
      shift
      ;;
    --no-models) models=0 ;;
    --no-viewer) viewer=0 ;;
    --remove) action=remove ;;
    --purge) action=purge ;;
    --help | -h) usage && exit 0 ;;
    *) fail "unknown option '$1'; see deploy/install.sh --help" 2 ;;
  esac
  shift
done

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  else
    command -v sudo >/dev/null || fail "you are not root and sudo is not installed; run this as root"
    sudo "$@"
  fi
}

apt() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -y -qq "$@" >/dev/null
}

if [ "$action" != install ]; then
  mapfile -t installed < <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' rtd-slam rtd-slam-viewer rtd-msgs-dev \
    python3-rtd-slam rtd-slam-doc 2>/dev/null | sed -n 's/^\(installed\|config-files\) //p')
  [ "${#installed[@]}" -gt 0 ] || fail "no package of RTD-SLAM is installed"
  apt "$action" "${installed[@]}"
  echo "install: $action of ${installed[*]}: done"
  exit 0
fi

[ -z "$source" ] || [ -d /run/systemd/system ] ||
  fail "--source starts the services with systemd, which does not run here"
if [ -z "$packages" ]; then
  packages="$root/build/release/packages"
  compgen -G "$packages/rtd-slam_*.deb" >/dev/null || "$root/deploy/package.sh"
fi
wanted=(rtd-slam)
[ "$viewer" -eq 0 ] || wanted+=(rtd-slam-viewer)
files=()
for package in "${wanted[@]}"; do
  newest="$(compgen -G "$packages/${package}_*.deb" | sort -V | tail -1 || true)"
  [ -n "$newest" ] || fail "no $package package in $packages; build it with deploy/package.sh"
  files+=("$(realpath "$newest")")
done

echo "install: installing ${wanted[*]}"
as_root apt-get update -qq
apt install --no-install-recommends "${files[@]}"

weights=/usr/local/share/rtd-slam/models
there=0
[ ! -f "$weights/yolox_nano.onnx" ] && [ ! -f "$weights/nanodet_g.onnx" ] || there=1
[ -f "$weights/selfie_segmentation.onnx" ] || there=0
if [ "$models" -eq 1 ] && [ "$there" -eq 0 ]; then
  # The weights are others' work under another licence: fetched, not packaged.
  "$root/deploy/setup.sh" --models
  found="$("$root/deploy/setup.sh" --product --check |
    sed -n 's/^\(detector weights\|masks of people\): \(\/.*\)/\2/p' || true)"
  while IFS= read -r file; do
    [ -n "$file" ] || continue
    as_root install -D -m 644 -t "$weights" "$file"
    [ ! -f "$file.licence.txt" ] || as_root install -m 644 -t "$weights" "$file.licence.txt"
    echo "install: ${file##*/} in $weights"
  done <<<"$found"
fi

runtime="$root/build/onnxruntime/lib/libonnxruntime.so" # of deploy/setup.sh, where npm is there
if [ -f "$runtime" ]; then
  as_root install -D -m 644 -t /usr/local/lib/rtd-slam "$runtime"
  echo "install: ONNX Runtime in /usr/local/lib/rtd-slam"
fi

if [ -z "$source" ]; then
  echo "install: next: rtd run --source synthetic:office --viewer --out DIR, or deploy/install.sh --source CAMERA to start at boot"
  exit 0
fi
echo "RTD_OPTIONS=--source $source" | as_root tee /etc/rtd-slam/camera.conf >/dev/null
as_root systemctl enable --now rtd-slam.target rtd-slam@camera rtd-slam@detector rtd-slam@filter rtd-slam@slam
echo "install: started; next: systemctl status 'rtd-slam@*', docs/operations.md"
