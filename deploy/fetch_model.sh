#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Downloads the public detector checkpoint, checks it, converts it to ONNX and puts it into the user's cache, where
# rtd-detector finds it. Does nothing if the model is already there. Called by deploy/setup.sh.
#   RTD_MODEL_URL     folder that contains the checkpoint, e.g. a mirror (default: its public home)
#   RTD_MODEL_SHA256  its checksum, for another checkpoint of the same name
#   XDG_CACHE_HOME    folder of the cache (default: ~/.cache)
# Exit code: 0 the model is there, 1 it is not (the message explains why).
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
repository=hejiahua007/yolov5-lite
commit=9718fb84c013651efd6b9b1d46edc728e8a432a2
checkpoint=v5lite-s.pt
sha256="${RTD_MODEL_SHA256:-13e49165932b0eb77072336a90293d7a1c7402c746a850ace9b6e9e931a1d543}"
url="${RTD_MODEL_URL:-https://raw.githubusercontent.com/$repository/$commit}"
url="${url%/}/$checkpoint"
input_size=480x640
cache="${XDG_CACHE_HOME:-${HOME:?fetch_model: neither XDG_CACHE_HOME nor HOME is set}/.cache}/rtd-slam"
model="$cache/v5lite-s-raw-$input_size.onnx"
attempts=3

fail() {
  echo "fetch_model: $1" >&2
  exit 1
}

require() {
  command -v curl >/dev/null || fail "curl is missing: run deploy/setup.sh"
  /usr/bin/python3 -c 'import numpy, onnx' 2>/dev/null ||
    fail "python3-numpy or python3-onnx is missing: run deploy/setup.sh"
}

# Explains curl's exit code.
explain() {
  case "$1" in
    5 | 6 | 7) echo "no connection to ${url%/"$checkpoint"}" ;;
    18) echo "the download was interrupted" ;;
    22) echo "the server does not have $url" ;;
    23) echo "cannot write to $cache" ;;
    28) echo "the server did not answer in time" ;;
    63) echo "the file is too large" ;;
    *) echo "curl failed with exit code $1" ;;
  esac
}

download() {
  local target="$1" attempt code
  for ((attempt = 1; attempt <= attempts; attempt++)); do
    code=0
    curl --fail --location --silent --proto '=http,https' --connect-timeout 10 --max-time 120 --max-filesize 500000000 \
      --output "$target" "$url" || code=$?
    [ "$code" -eq 0 ] && return
    [ "$code" -eq 22 ] && break # the server refused: another attempt does not help
    [ "$attempt" -lt "$attempts" ] && sleep "$attempt"
  done
  fail "cannot fetch $checkpoint: $(explain "$code"). Try again later, or set RTD_MODEL_URL to a mirror"
}

verify() {
  local found
  found="$(sha256sum "$1" | cut -d' ' -f1)"
  [ "$found" = "$sha256" ] || fail "wrong checksum of $url: $found, expected $sha256. Nothing was installed"
}

if [ -f "$model" ]; then
  echo "fetch_model: already installed: $model"
  exit 0
fi
require
mkdir -p "$cache" 2>/dev/null || fail "cannot create $cache"
work="$(mktemp -d "$cache/fetch.XXXXXX")" || fail "cannot write to $cache"
trap 'rm -rf "$work"' EXIT
echo "fetch_model: downloading $url (YOLOv5-Lite s by ppogg, GPL-3.0)"
download "$work/$checkpoint"
verify "$work/$checkpoint"
/usr/bin/python3 -B "$root/services/detector/tools/yolov5_to_onnx.py" "$work/$checkpoint" "$work/model.onnx" \
  --size "$input_size" >/dev/null || fail "the checkpoint could not be converted"
mv -f "$work/model.onnx" "$model" # same file system: other processes see the whole file or none
echo "fetch_model: installed $model"
