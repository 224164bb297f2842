#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Downloads the weights of a detector network, checks them, makes the ONNX file of them that rtd-detector finds in the
# user's cache, and puts their licence beside it. Does nothing if the file is already there. Called by deploy/setup.sh.
#   fetch_model.sh [--accept-hash] [yolox-nano | yolov5-lite]     default: yolox-nano
#   --accept-hash     take a file with another checksum if its outputs on a fixed image are right (yolox-nano)
#   RTD_MODEL_URL     folder that contains the download, e.g. a mirror (default: its public home)
#   RTD_MODEL_SHA256  its checksum, for another file of the same name
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
    yolov5-lite)
      title="YOLOv5-Lite s by ppogg, GPL-3.0"
      download=v5lite-s.pt
      home=https://raw.githubusercontent.com/hejiahua007/yolov5-lite/9718fb84c013651efd6b9b1d46edc728e8a432a2
      sha256=13e49165932b0eb77072336a90293d7a1c7402c746a850ace9b6e9e931a1d543
      model=v5lite-s-raw-480x640.onnx
      licence=/usr/share/common-licenses/GPL-3
      changes="converted to ONNX for an input of 640x480"
      ;;
    *)
      echo "fetch_model: unknown network '$1': use yolox-nano or yolov5-lite" >&2
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
  fail "cannot fetch $download: $(explain "$code"). Try again later, or set RTD_MODEL_URL to a mirror"
}

verify() {
  local found advice=""
  found="$(sha256sum "$1" | cut -d' ' -f1)"
  [ "$found" = "$sha256" ] && return
  [ "$download" = yolox_nano.onnx ] && advice=", or add --accept-hash to check what it computes in place of its checksum"
  if [ "$accept_hash" -eq 0 ] || [ -z "$advice" ]; then
    fail "wrong checksum of $url: $found, expected $sha256. Nothing was installed; look at where it comes from$advice"
  fi
  echo "fetch_model: checksum $found, expected $sha256: checking what it computes"
  /usr/bin/python3 -B "$tools/check_yolox_nano.py" "$1" || fail "$url is not YOLOX-nano. Nothing was installed"
}

# convert DOWNLOAD OUT
convert() {
  case "$download" in
    *.pt) /usr/bin/python3 -B "$tools/yolov5_to_onnx.py" "$1" "$2" --size 480x640 >/dev/null ;;
    *) /usr/bin/python3 -B "$tools/yolov5_to_onnx.py" --free-batch "$1" "$2" >/dev/null ;;
  esac || fail "$download could not be converted"
}

write_licence() {
  printf '%s\nSource: %s\nSHA-256 of the source: %s\nChanges: %s\n\n' "$title" "$url" \
    "$(sha256sum "$work/$download" | cut -d' ' -f1)" "$changes"
  cat "$licence" 2>/dev/null || echo "The text of the licence is not on this computer: see spdx.org/licenses"
}

name=yolox-nano
for argument in "$@"; do
  if [ "$argument" = --accept-hash ]; then accept_hash=1; else name="$argument"; fi
done
choose "$name"
if [ -f "$cache/$model" ]; then
  echo "fetch_model: already installed: $cache/$model"
  exit 0
fi
require
mkdir -p "$cache" 2>/dev/null || fail "cannot create $cache"
work="$(mktemp -d "$cache/fetch.XXXXXX")" || fail "cannot write to $cache"
trap 'rm -rf "$work"' EXIT
echo "fetch_model: downloading $url ($title)"
fetch "$work/$download"
verify "$work/$download"
convert "$work/$download" "$work/model.onnx"
write_licence >"$work/licence.txt"
mv -f "$work/licence.txt" "$cache/$model.licence.txt"
mv -f "$work/model.onnx" "$cache/$model" # same file system: other processes see the whole file or none
echo "fetch_model: installed $cache/$model ($title; its licence lies beside it)"
