#!/bin/sh
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# man_page.sh HELP2MAN PROGRAM VERSION PAGE: writes the manual page of a program, made of its --help.
set -eu
name="$(basename "$2")"
summary="$("$2" --help | sed -n '1{s/\.$//;p;}')"
mkdir -p "$(dirname "$4")"
"$1" --no-info --no-discard-stderr --version-string="$3" --name="$summary" --manual="RTD-SLAM" "$2" |
  sed "s|$2|$name|g" | gzip -9n > "$4"
