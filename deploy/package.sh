#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds the Debian packages rtd-slam, rtd-slam-viewer, rtd-msgs-dev, python3-rtd-slam and rtd-slam-doc into
# build/release/packages.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# shellcheck source=deploy/environment.sh
. "$root/deploy/environment.sh"

if [ "${1:-}" = --help ]; then
  echo "Usage: deploy/package.sh      builds the Debian packages, checks them with lintian, and says where they are"
  exit 0
elif [ $# -gt 0 ]; then
  echo "package: unknown option '$1'; see deploy/package.sh --help" >&2
  exit 2
fi

"$root/deploy/setup.sh" --product --packaging
echo "package: building into build/release"
tests=OFF
grep -qs '^RTD_BUILD_TESTS:BOOL=ON' "$root/build/release/CMakeCache.txt" && tests=ON
build_release "$tests" --target rtd_packages
rm -rf "$root/build/release/packages"
(cd "$root/build/release" && cpack -G DEB >cpack.log 2>&1) || {
  cat "$root/build/release/cpack.log" >&2
  exit 1
}
rm -rf "$root/build/release/packages/_CPack_Packages"
lintian --allow-root --fail-on error,warning "$root"/build/release/packages/*.deb || {
  echo "package: lintian refuses the packages in build/release/packages for what it says above" >&2
  exit 1
}
for package in "$root"/build/release/packages/*.deb; do
  echo "package: $(du -h "$package" | cut -f 1) ${package#"$PWD/"}"
done
echo "package: next: ./deploy/install.sh"
