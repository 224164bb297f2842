#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Unit tests of the viewer's page, in node: no browser, no npm package. Exit code 77 = skipped: node is not installed.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
if ! command -v node >/dev/null; then
  echo "SKIPPED: node is not installed; deploy/setup.sh --viewers installs it"
  exit 77
fi
exec node --test "$here"/*.test.mjs
