#!/bin/sh
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# check_units.sh UNITS_FOLDER BIN_FOLDER: systemd accepts rtd-slam.target and rtd-slam@.service for each service, their
# exposure is at most 3.0, and each service takes the options of rtd-slam.conf. Exit code 77 = skipped: no systemd.
set -eu
units="$1" bin="$2"
for unit in "$units"/*.service; do
  grep -q '^MemoryHigh=' "$unit" && grep -q '^MemoryMax=' "$unit" || { echo "$unit: memory without a limit"; exit 1; }
done
command -v systemd-analyze >/dev/null || { echo "SKIPPED: systemd-analyze is not installed"; exit 77; }
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

cp -r "$units/." "$folder"
sed -i "s|/usr/local/bin/|$bin/|; s|^User=.*|User=root|; s|^Group=.*|Group=root|; s|/etc/rtd-slam/rtd-slam.conf|$folder/rtd-slam.conf|" \
  "$folder/rtd-slam@.service"
common="$(sed -n 's|^RTD_COMMON_OPTIONS=||p' "$units/rtd-slam.conf")"
failed=0
for service in camera detector filter slam dense record viewer link atlas; do
  unit="rtd-slam@$service.service"
  cp "$folder/rtd-slam@.service" "$folder/$unit"
  problems="$(SYSTEMD_UNIT_PATH="$folder:" systemd-analyze verify "$folder/$unit" 2>&1 | grep "rtd-slam" || true)"
  [ -z "$problems" ] || { echo "$unit: $problems"; failed=1; }
  # shellcheck disable=SC2086  # several words on purpose
  "$bin/rtd-$service" $common --print-config >/dev/null || { echo "rtd-$service refuses: $common"; failed=1; }
done
# The account of the units need not exist here; root would count as exposed.
sed -i 's|^User=.*|User=nobody|; s|^Group=.*|Group=nogroup|' "$folder"/rtd-slam@*.service
for service in slam camera detector; do
  exposure="$(SYSTEMD_UNIT_PATH="$folder:" systemd-analyze security --offline=true "rtd-slam@$service.service" 2>&1 |
    sed -n 's|.*exposure level for [^:]*: \([0-9.]*\).*|\1|p')"
  echo "rtd-slam@$service: exposure $exposure"
  [ -n "$exposure" ] && [ "$(printf '%s\n3.0\n' "$exposure" | sort -n | tail -1)" = 3.0 ] || failed=1
done
exit $failed
