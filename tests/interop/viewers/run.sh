#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Records a short run and opens the recording with other people's readers.
#   run.sh RTD MCAP_DIGEST TOOLS_DIR mcap|rerun     TOOLS_DIR: where `deploy/setup.sh --viewers` put the npm packages
# Exit code 77 = skipped: node, an npm package or Chromium is not there.
set -euo pipefail
rtd="$1" digest="$2" tools="$3" viewer="$4"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"

skip() {
  echo "SKIPPED: $1; deploy/setup.sh --viewers installs it"
  exit 77
}
command -v node >/dev/null || skip "node is not installed"
[ -d "$tools/node_modules/@mcap/core" ] || skip "the npm packages of tests/interop/viewers are not in $tools"
chromium="$(command -v chromium || true)"
[ "$viewer" != rerun ] || [ -n "$chromium" ] || skip "chromium is not installed"

work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
export ROS_DOMAIN_ID="${RTD_TEST_DOMAIN:-97}"
"$rtd" run --source "synthetic:office?frames=45" --filter geometry --pace asap --out "$work/run" \
  --record "$work/run.mcap" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
"$digest" "$work/run.mcap" >"$work/digest.json"
cp "$here"/*.mjs "$tools/"  # beside node_modules, where imports are looked up
if [ "$viewer" = mcap ]; then
  node "$tools/check_mcap.mjs" "$work/run.mcap" "$work/digest.json"
else
  node "$tools/check_rerun.mjs" "$work/run.mcap" "$work/digest.json" "$chromium" "$tools/rerun.png"
fi
