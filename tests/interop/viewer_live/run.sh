#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# rtd viewer with the real services: in Chromium (of one robot, of two, the pages that a run leaves behind), or with Foxglove's client library.
#   run.sh RTD TOOLS_DIR live|files|foxglove|robots [SCREENSHOT_DIR]   TOOLS_DIR: where `deploy/setup.sh --viewers` put the npm packages
# Exit code 77 = skipped: node, an npm package or Chromium is not there.
set -euo pipefail
rtd="$(realpath -m "$1")" tools="$(realpath -m "$2")" what="$3" screenshots="${4:-}"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"

skip() {
  echo "SKIPPED: $1; deploy/setup.sh --viewers installs it"
  exit 77
}
command -v node >/dev/null || skip "node is not installed"
[ "$what" = foxglove ] || command -v chromium >/dev/null || skip "chromium is not installed"
[ -d "$tools/node_modules/playwright-core" ] || skip "the npm package playwright-core is not in $tools"
[ -d "$tools/node_modules/@foxglove/ws-protocol" ] || skip "the npm package @foxglove/ws-protocol is not in $tools"

export RTD_EXECUTABLE="$rtd" RTD_NODE_TOOLS="$tools" RTD_SCREENSHOTS="$screenshots"
RTD_CHROMIUM="$(command -v chromium || true)"
export RTD_CHROMIUM
exec node --test --test-concurrency=1 "$here/$what.test.mjs"
