#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Makes a copy of a clip in TUM layout whose camera rolls about its viewing axis, up to an angle and back.

    roll_clip.py walk_xyz /tmp/walk_xyz_rolled --degrees 120

A roll about the optical axis does not change the viewpoint, so the copy shows what such a camera would have seen.
Corners outside the original image are black and have no depth. The images must be free of distortion, as the rendered
clips are.
"""

import argparse
import math
import pathlib
import re
import shutil
import sys

import cv2
import numpy as np


def read_camera(path):
    text = path.read_text()
    return [float(re.search(rf"\b{key}:\s*([-\d.]+)", text).group(1)) for key in ("fx", "fy", "cx", "cy")]


def roll_image(image, camera, degrees, interpolation):
    """K R_z K^-1: the content turns counter-clockwise, as for a camera that rolls clockwise."""
    fx, fy, cx, cy = camera
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    turn = np.array([[c, s * fx / fy], [-s * fy / fx, c]])
    offset = np.array([cx, cy]) - turn @ np.array([cx, cy])
    return cv2.warpAffine(image, np.column_stack((turn, offset)), image.shape[1::-1], flags=interpolation)


def rolled_quaternion(quaternion, degrees):
    """q * (turn about z): T_world_camera of the rolled camera."""
    x, y, z, w = quaternion
    half = math.radians(degrees) / 2
    s, c = math.sin(half), math.cos(half)
    return x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s


def roll_groundtruth(source, target, roll_at):
    lines = []
    for line in source.read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            words = line.split()
            turned = rolled_quaternion(map(float, words[4:8]), roll_at(float(words[0])))
            line = " ".join(words[:4] + [f"{value:.9f}" for value in turned])
        lines.append(line)
    target.write_text("\n".join(lines) + "\n")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clip", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--degrees", type=float, default=120, help="largest roll (120)")
    options = parser.parse_args(arguments)
    camera = read_camera(options.clip / "calibration.yaml")
    stamps = sorted(float(path.stem) for path in (options.clip / "rgb").iterdir())
    middle, half = (stamps[0] + stamps[-1]) / 2, (stamps[-1] - stamps[0]) / 2
    # a cosine: starts and ends upright and at rest
    roll_at = lambda stamp: options.degrees * 0.5 * (1 + math.cos(math.pi * np.clip((stamp - middle) / half, -1, 1)))

    options.out.mkdir(parents=True, exist_ok=True)
    for path in options.clip.iterdir():
        if path.is_file() and path.name != "groundtruth.txt":
            shutil.copy(path, options.out / path.name)
    for folder, interpolation in (("rgb", cv2.INTER_LINEAR), ("depth", cv2.INTER_NEAREST), ("mask", cv2.INTER_NEAREST)):
        if not (options.clip / folder).is_dir():
            continue
        (options.out / folder).mkdir(exist_ok=True)
        for path in sorted((options.clip / folder).iterdir()):
            image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
            turned = roll_image(image, camera, roll_at(float(path.stem)), interpolation)
            cv2.imwrite(str(options.out / folder / path.name), turned)
    roll_groundtruth(options.clip / "groundtruth.txt", options.out / "groundtruth.txt", roll_at)


if __name__ == "__main__":
    main(sys.argv[1:])
