#!/bin/sh
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# check_box_unit.sh UNIT RTD_DETECTOR: systemd accepts the unit, and rtd-detector the command line in it.
set -eu
unit="$1" detector="$2"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
installed=/usr/local/bin/rtd-detector

line="$(sed -n "s|^ExecStart=$installed ||p" "$unit" | sed 's| \$RTD_BOX_OPTIONS$||')"
[ -n "$line" ] || { echo "$unit: no ExecStart=$installed"; exit 1; }
# shellcheck disable=SC2086  # several words on purpose
"$detector" $line --print-config >"$folder/config" || { echo "rtd-detector refuses: $line"; exit 1; }

command -v systemd-analyze >/dev/null || exit 77
sed "s|$installed|$detector|" "$unit" >"$folder/rtd-detector-box.service"
problems="$(systemd-analyze verify "$folder/rtd-detector-box.service" 2>&1 | grep rtd-detector-box || true)"
[ -z "$problems" ] || { echo "$problems"; exit 1; }
