#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs missing packages, builds, and runs one scene without and with removal of dynamic points.
# Arguments are passed to `rtd demo`, e.g. deploy/demo.sh --frames 100
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# shellcheck source=deploy/environment.sh
. "$root/deploy/environment.sh"

if [ "${1:-}" = "--help" ]; then
  echo "Usage: deploy/demo.sh [arguments of rtd demo]   e.g. --frames 100, --out FOLDER, --dds cyclonedds"
  exit 0
fi

"$root/deploy/setup.sh" --product
echo "demo: building into build/release"
tests=OFF
grep -qs '^RTD_BUILD_TESTS:BOOL=ON' "$root/build/release/CMakeCache.txt" && tests=ON
build_release "$tests" --target rtd_demo
exec "$root/build/release/bin/rtd" demo "$@"
