#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# The viewer's page in a headless Chromium, against the server double of tests/support/viewer_page.
#   run.sh TOOLS_DIR [SCREENSHOT_DIR]     TOOLS_DIR: where `deploy/setup.sh --viewers` put the npm packages
# Exit code 77 = skipped: node, an npm package, Chromium or three.js is not there.
set -euo pipefail
tools="$(realpath -m "$1")" screenshots="${2:-}"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"

skip() {
  echo "SKIPPED: $1; deploy/setup.sh --viewers installs it"
  exit 77
}
command -v node >/dev/null || skip "node is not installed"
command -v chromium >/dev/null || skip "chromium is not installed"
[ -d "$tools/node_modules/playwright-core" ] || skip "the npm package playwright-core is not in $tools"
[ -d "$tools/node_modules/ws" ] || [ -d /usr/share/nodejs/ws ] || skip "the npm package ws is not in $tools"
[ -f /usr/share/javascript/three/three.module.js ] || skip "libjs-three is not installed"

export RTD_NODE_TOOLS="$tools" RTD_CHROMIUM="$(command -v chromium)" RTD_SCREENSHOTS="$screenshots"
exec node --test --test-concurrency=1 "$here"/*.test.mjs
