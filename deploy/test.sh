#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs missing packages, builds everything and runs the tests, with --all also those labelled nightly. Other
# arguments are passed to ctest, e.g. deploy/test.sh -L unit
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# shellcheck source=deploy/environment.sh
. "$root/deploy/environment.sh"

if [ "${1:-}" = "--help" ]; then
  echo "Usage: deploy/test.sh [--all] [ctest arguments]   e.g. -L unit, -L 'unit|component', -R camera"
  echo "  --all   also the tests labelled nightly: more scenes and vendors, packages, counts of instructions; and bounds on time,"
  echo "          which only a quiet machine keeps"
  exit 0
fi
chosen=(-LE nightly)
targets=(--target all)
if [ "${1:-}" = "--all" ]; then
  chosen=()
  targets+=(rtd_benches)
  export RTD_TIME_BOUNDS=1
  shift
fi

# What did not run, and why. ctest itself names only executables of which every check was skipped.
list_skipped() {
  awk '/: Skipped$/ { getline reason }
       /^\[  SKIPPED \] .* \(/ { count[reason]++; first[reason] = $4; total++ }
       / \.\.\. skipped / { split($0, part, " ... skipped "); count[part[2]]++; first[part[2]] = $1; total++ }
       END {
         if (total) print "test: " total " checks were skipped:"
         for (reason in count) print "  " count[reason] " x " reason " (" first[reason] ")"
       }' "$root/build/release/Testing/Temporary/LastTest.log"
}

started=$SECONDS
"$root/deploy/setup.sh" --no-models
echo "test: building into build/release"
build_release ON "${targets[@]}"
built=$SECONDS

status=0
# One more than there are cores: tests of several processes mostly wait.
ctest --test-dir "$root/build/release" -j "$(($(nproc) + 1))" --output-on-failure --no-tests=error "${chosen[@]}" "$@" || status=$?
list_skipped
echo "test: tests took $((SECONDS - built)) s, total $((SECONDS - started)) s"
if [ "$status" -eq 0 ]; then
  echo "test: next: ./deploy/demo.sh"
else
  echo "test: details: build/release/Testing/Temporary/LastTest.log" >&2
fi
exit "$status"
