#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Draws kept and removed points of one frame of a report over the true mask, as SVG without the photograph.

Usage: tests/campaigns/points_picture.py REPORT.html FRAME MASK.png OUT.svg [--dark]
--dark: moving objects are black in the mask.
This script made the images of docs/lab/accuracy.md. It needs python3-opencv.
"""
import re
import sys

import cv2


def samples(html):
    """Frame number -> caption and points by colour."""
    found = {}
    for figure in re.findall(r"<figure>.*?</figure>", html, re.S):
        title = re.search(r"frame (\d+): [^<]*", figure)
        if title is None:
            continue
        points = {}
        for path in re.finditer(r'<path d="([^"]+)"[^>]*stroke="(#[0-9a-f]{6})"', figure):
            points[path.group(2)] = re.findall(r"M(\d+) (\d+)h0", path.group(1))
        found[int(title.group(1))] = (title.group(0), points)
    return found


def outline(mask_file, dark):
    mask = cv2.imread(mask_file, cv2.IMREAD_GRAYSCALE)
    if mask is None:
        sys.exit(f"points_picture: {mask_file} is not an image")
    moving = (mask < 128) if dark else (mask > 127)
    contours, _ = cv2.findContours(moving.astype("uint8"), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    smooth = [cv2.approxPolyDP(c, 1.0, True)[:, 0, :] for c in contours if cv2.contourArea(c) > 60]
    return " ".join("M" + "L".join(f"{x} {y}" for x, y in c) + "Z" for c in smooth)


def main():
    arguments = [a for a in sys.argv[1:] if a != "--dark"]
    if arguments in (["-h"], ["--help"]):
        print(__doc__)
        sys.exit(0)
    if len(arguments) != 4:
        sys.exit(__doc__)
    report, frame, mask, out = arguments
    with open(report, encoding="utf-8") as file:
        known = samples(file.read())
    if int(frame) not in known:
        sys.exit(f"points_picture: {report} holds frames {sorted(known)}, not {frame}")
    caption, points = known[int(frame)]
    dots = "".join(
        f'<path d="{"".join(f"M{x} {y}h0" for x, y in points.get(color, []))}" stroke="{shown}"/>'
        for color, shown in (("#35e07a", "#1a7f37"), ("#f5222d", "#d1242f")))
    with open(out, "w", encoding="utf-8") as file:
        file.write(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 480" width="480" height="360" role="img">'
            f"<title>{caption}</title>"
            f'<rect width="640" height="480" fill="#f6f8fa"/>'
            f'<path d="{outline(mask, "--dark" in sys.argv)}" fill="#d0d7de" fill-rule="evenodd"/>'
            f'<g fill="none" stroke-width="7" stroke-linecap="round">{dots}</g></svg>\n')


if __name__ == "__main__":
    main()
