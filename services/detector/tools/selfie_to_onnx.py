#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Converts MediaPipe's network for person masks from TensorFlow Lite to the ONNX file that rtd-detector reads.

    selfie_to_onnx.py selfie_segmentation.tflite selfie_segmentation.onnx

Needs Debian's python3-numpy and python3-onnx. Executes nothing that the file names.
"""

import argparse
import sys

from tflite_onnx.person_mask import convert
from tflite_onnx.reader import load_model
from yolov5_onnx.errors import ConversionError
from yolov5_to_onnx import check_sha256, save_atomically

SHA256 = "8d13b7fae74af625c641226813616a2117bd6bca19eb3b75574621fc08557f27"
METADATA = {"rtd.licence": "Apache-2.0", "rtd.source": "MediaPipe Selfie Segmentation by Google"}


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("network", metavar="IN.tflite")
    parser.add_argument("output", metavar="OUT.onnx")
    parser.add_argument("--any", action="store_true", help="take a file with another checksum; its licence is unknown")
    options = parser.parse_args(arguments)
    try:
        if not options.any:
            check_sha256(options.network, SHA256)
        model, parameters = convert(load_model(options.network), {} if options.any else METADATA)
        save_atomically(model, options.output)
    except ConversionError as error:
        print(f"selfie_to_onnx: {error}", file=sys.stderr)
        return 1
    print(f"{options.output}: {parameters / 1e6:.3f} M parameters")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
