#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# CDR bytes of the standard types against another implementation, in both directions.
#   run.sh CDR_SAMPLES TOOLS_DIR     TOOLS_DIR: where `deploy/setup.sh --viewers` put the npm packages
# Exit code 77 = skipped: node or an npm package is not there.
set -euo pipefail
samples="$1" tools="$2"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"

skip() {
  echo "SKIPPED: $1; deploy/setup.sh --viewers installs it"
  exit 77
}
command -v node >/dev/null || skip "node is not installed"
for package in rosmsg rosmsg2-serialization rosmsg-msgs-common; do
  [ -d "$tools/node_modules/@foxglove/$package" ] || skip "the npm package @foxglove/$package is not in $tools"
done

work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
"$samples" types >"$work/types.jsonl"
"$samples" write >"$work/ours.jsonl"
cp "$here/check_cdr.mjs" "$tools/"  # beside node_modules, where imports are looked up
node "$tools/check_cdr.mjs" "$work/types.jsonl" "$work/ours.jsonl" "$work/theirs.jsonl"
"$samples" check <"$work/theirs.jsonl"
