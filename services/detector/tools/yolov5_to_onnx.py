#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Converts a YOLOv5 or YOLOv5-Lite checkpoint (.pt) to the ONNX file that rtd-detector reads.

    yolov5_to_onnx.py v5lite-s.pt v5lite-s-raw-480x640.onnx --size 480x640
    yolov5_to_onnx.py --free-batch old.onnx new.onnx

Needs Debian's python3-numpy and python3-onnx. Executes nothing that the checkpoint names.
"""

import argparse
import hashlib
import os
import re
import sys
import tempfile

import onnx
from google.protobuf.message import DecodeError

from yolov5_onnx.batch import free_batch
from yolov5_onnx.checkpoint import load_checkpoint
from yolov5_onnx.errors import ConversionError
from yolov5_onnx.network import convert


def parse_size(text):
    """ "480x640" -> (480, 640)."""
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    if not match:
        raise argparse.ArgumentTypeError(f"'{text}' is not HEIGHTxWIDTH, e.g. 480x640")
    return int(match.group(1)), int(match.group(2))


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkpoint", metavar="IN.pt", help="checkpoint, or with --free-batch an ONNX file")
    parser.add_argument("output", metavar="OUT.onnx")
    parser.add_argument("--size", type=parse_size, default=(480, 640), metavar="HxW", help="input size (480x640)")
    parser.add_argument(
        "--free-batch", action="store_true", help="IN is an ONNX file for one image: let it take any number at once"
    )
    parser.add_argument("--sha256", help="refuse a checkpoint with another checksum")
    return parser.parse_args(arguments)


def check_sha256(path, expected):
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            for block in iter(lambda: file.read(1 << 20), b""):
                digest.update(block)
    except OSError as error:
        raise ConversionError(f"{path}: {error.strerror}") from error
    if digest.hexdigest() != expected.lower():
        raise ConversionError(f"{path}: SHA-256 is {digest.hexdigest()}, expected {expected}: not the expected file")


def save_atomically(model, path):
    """Writes the file in one step: other processes never see a part of it."""
    folder = os.path.dirname(os.path.abspath(path))
    try:
        with tempfile.NamedTemporaryFile(dir=folder, suffix=".part", delete=False) as file:
            file.write(model.SerializeToString())
        os.chmod(file.name, 0o644)
        os.replace(file.name, path)
    except OSError as error:
        raise ConversionError(f"cannot write {path}: {error.strerror}") from error


def load_onnx(path):
    try:
        return onnx.load(path)
    except OSError as error:
        raise ConversionError(f"{path}: {error.strerror}") from error
    except DecodeError as error:
        raise ConversionError(f"{path}: not an ONNX file, or truncated") from error


def free_batch_of_file(options):
    model = load_onnx(options.checkpoint)
    if not model.graph.node:
        raise ConversionError(f"{options.checkpoint}: not an ONNX file, or truncated")
    changed = free_batch(model)
    save_atomically(model, options.output)
    print(f"{options.output}: takes any number of images at once ({changed} Reshapes changed)")
    return 0


def main(arguments):
    options = parse_arguments(arguments)
    try:
        if options.sha256:
            check_sha256(options.checkpoint, options.sha256)
        if options.free_batch:
            return free_batch_of_file(options)
        model, parameters = convert(load_checkpoint(options.checkpoint), *options.size)
        save_atomically(model, options.output)
    except (ConversionError, onnx.checker.ValidationError) as error:
        print(f"yolov5_to_onnx: {error}", file=sys.stderr)
        return 1
    height, width = options.size
    print(f"{options.output}: {parameters / 1e6:.3f} M parameters, input {width} x {height}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
