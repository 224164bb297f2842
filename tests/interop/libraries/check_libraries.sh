#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# No installed program or plug-in may bring libraries under the GPL or OpenCV modules that bring some: imgcodecs and
# videoio load GDAL, poppler, x264, x265 and FFmpeg.
#   check_libraries.sh FILE...     programs and libraries as they are installed
set -euo pipefail
unwanted='lib(opencv_(imgcodecs|videoio|highgui)|gdal|poppler|x264|x265|avcodec|avformat|gslcblas|gsl)[.0-9-]*\.so'
status=0
for file in "$@"; do
  libraries="$(ldd "$file")"
  grep -q 'libc\.so' <<<"$libraries" || { echo "$file: ldd lists no library" && status=1; }
  if grep -E "$unwanted" <<<"$libraries" | sed "s|^|$file loads |"; then status=1; fi
done
# The search itself: OpenCV's module for image files has such libraries.
if [ -n "${RTD_KNOWN_BAD:-}" ] && ! grep -qE "$unwanted" <<<"$(ldd "$RTD_KNOWN_BAD")"; then
  echo "the search finds nothing in $RTD_KNOWN_BAD" && status=1
fi
[ "$status" -ne 0 ] || echo "$# files load none of them"
exit "$status"
