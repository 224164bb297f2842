#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that an ONNX file computes what YOLOX-nano computes on a fixed image.

    check_yolox_nano.py FILE.onnx

The image is made here, and some of the outputs of the file with the known checksum are recorded here. Needs Debian's
python3-opencv. Exit codes: 0 it does, 1 it does not, 2 it could not be checked.
"""

import sys

import numpy as np

SIZE = 416
SHAPE = (1, 3549, 85)
TOLERANCE = 0.01
ROWS = range(50, 3549, 350)  # cells of all three strides
# x y w h objectness of these
EXPECTED = (
    -0.7925, 0.7729, 1.5258, 0.4010, 0.0002,
    0.3839, 0.7696, 1.5315, 0.6609, 0.0000,
    -0.1776, 0.1737, 2.3650, 2.4539, 0.0000,
    0.0936, 0.5310, 1.8135, 2.3714, 0.0000,
    0.3049, 0.1760, 2.2751, 2.0523, 0.0000,
    0.2537, 1.2654, 2.2320, 2.4459, 0.0000,
    0.2957, 1.8609, 1.5878, 2.2200, 0.0000,
    0.1354, -0.1409, 1.4325, 2.0346, 0.0000,
    -0.1396, 0.3900, 2.6431, 2.1464, 0.0000,
    -0.0448, 0.3154, 1.3516, 2.4357, 0.0059,
)


def fixed_image():
    """A pattern of edges and areas of all sizes, 1 x 3 x SIZE x SIZE, 0 to 255."""
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    channels = [(x * (3 + c) + y * (5 - c)) // 4 ^ (x * y // 64) for c in range(3)]
    return (np.stack(channels) % 256).astype(np.float32)[np.newaxis]


def outputs_of(path):
    import cv2  # slow, and not everywhere

    network = cv2.dnn.readNetFromONNX(path)
    network.setInput(fixed_image())
    return network.forward()


def recorded_part(outputs):
    """x y w h objectness of some cells."""
    return outputs[0, list(ROWS), :5].ravel()


def problem_of(outputs):
    """Why these are not the outputs of YOLOX-nano; empty when they are."""
    if outputs.shape != SHAPE:
        return f"its output is {outputs.shape}, expected {SHAPE}"
    largest = np.abs(recorded_part(outputs) - np.array(EXPECTED)).max()
    if not largest <= TOLERANCE:
        return f"its outputs differ by up to {largest:.3g}, allowed is {TOLERANCE}"
    return ""


def main(arguments):
    if len(arguments) != 1:
        print("usage: check_yolox_nano.py FILE.onnx", file=sys.stderr)
        return 2
    try:
        outputs = outputs_of(arguments[0])
    except ImportError:
        print("check_yolox_nano: python3-opencv is missing: apt-get install python3-opencv", file=sys.stderr)
        return 2
    except Exception as error:  # OpenCV's own class
        print(f"check_yolox_nano: {arguments[0]} cannot be read: {error}", file=sys.stderr)
        return 1
    if problem := problem_of(outputs):
        print(f"check_yolox_nano: {arguments[0]}: {problem}", file=sys.stderr)
        return 1
    print(f"check_yolox_nano: {arguments[0]} computes what YOLOX-nano computes")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
