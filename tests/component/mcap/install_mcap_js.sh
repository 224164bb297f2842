#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the MCAP project's own reader (npm: @mcap/core, @mcap/support; MIT) into the build tree, for
# interop.test_mcap_js. Usage: tests/component/mcap/install_mcap_js.sh [build folder, default build/release]
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)"
folder="${1:-$root/build/release}/mcap_js"
command -v npm >/dev/null || {
  echo "install_mcap_js: npm is missing: apt-get install nodejs npm" >&2
  exit 1
}
npm install --prefix "$folder" --ignore-scripts --no-audit --no-fund --no-save @mcap/core@2.2.2 @mcap/support@1.1.0
echo "install_mcap_js: in $folder; now: ctest --test-dir ${1:-$root/build/release} -R mcap_js"
