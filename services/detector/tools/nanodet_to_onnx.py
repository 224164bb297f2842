#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Converts NanoDet as a graph model of TensorFlow.js to the ONNX file that rtd-detector reads.

    nanodet_to_onnx.py nanodet.json nanodet.bin nanodet_g.onnx

Needs Debian's python3-numpy and python3-onnx. Executes nothing that the files name.
"""

import argparse
import sys

from tfjs_onnx.nanodet import convert
from tfjs_onnx.reader import load_graph_model
from yolov5_onnx.errors import ConversionError
from yolov5_to_onnx import save_atomically


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("graph", metavar="IN.json")
    parser.add_argument("weights", metavar="IN.bin")
    parser.add_argument("output", metavar="OUT.onnx")
    options = parser.parse_args(arguments)
    try:
        model, parameters = convert(load_graph_model(options.graph, options.weights))
        save_atomically(model, options.output)
    except ConversionError as error:
        print(f"nanodet_to_onnx: {error}", file=sys.stderr)
        return 1
    print(f"{options.output}: {parameters / 1e6:.3f} M parameters")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
