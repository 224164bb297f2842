#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Makes the pictures of docs/viewer.md from a real run: tests/campaigns/viewer_screenshots.sh [SOURCE] [FOLDER]
# Needs a build, Chromium and node packages: deploy/setup.sh --viewers.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
source="${1:-synthetic:office?frames=1200&people=2&boxes=0&figures=drawn}" folder="${2:-$root/docs/images}"
tools="$root/build/release/viewers" port=8799
[ -d "$tools/node_modules/playwright-core" ] || { echo "playwright-core is missing: run deploy/setup.sh --viewers" >&2; exit 2; }

mkdir -p "$folder"
work="$(mktemp -d)"
"$root/build/release/bin/rtd" run --source "$source" --pace realtime --out "$work/out" --domain 93 --viewer --set viewer.port=$port --set viewer.token=pictures \
  >"$work/log" 2>&1 &
run=$!
trap 'kill $run 2>/dev/null || true; wait $run 2>/dev/null || true; rm -rf "$work"' EXIT
RTD_NODE_TOOLS="$tools" node "$root/tests/campaigns/viewer_screenshots.mjs" "http://127.0.0.1:$port/?token=pictures" "$folder" || {
  cat "$work/log" >&2
  exit 1
}
