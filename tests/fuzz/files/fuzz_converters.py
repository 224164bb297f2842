#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Damaged networks for the readers of TensorFlow Lite and of TensorFlow.js: each is converted or refused with a
ConversionError, soon and with little memory. Both are Python: there is nothing that a sanitizer would see.

    fuzz_converters.py [INPUTS [SEED]]     of each kind; default 500
"""

import json
import pathlib
import random
import resource
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "services/detector/tools"), str(ROOT / "tests/unit/detector/tools")]

from test_nanodet_converter import SmallGraph  # noqa: E402
from tflite_onnx import person_mask, reader  # noqa: E402
from tfjs_onnx.nanodet import convert as convert_nanodet  # noqa: E402
from tfjs_onnx.reader import load_graph_model  # noqa: E402
from tiny_lite import TinyLite  # noqa: E402
from yolov5_onnx.errors import ConversionError  # noqa: E402

MOST_SECONDS, MOST_MEMORY_MIB = 5, 512
NUMBERS = (0, 1, 2, 3, 4, 7, 8, 63, 127, 128, 255, 256, 4095, 65535, 1 << 20, 1 << 30, (1 << 31) - 1, 1 << 31,
           (1 << 32) - 1)  # fmt: skip
VALUES = (None, True, False, 0, -1, 1, 3, 1 << 31, 1 << 64, -1e300, 1e308, 0.5, "", "1", "VALID", "99999999999", [], {},
          [[]], [1, 2, 3, 4], {"list": {"i": ["-1", "0"]}}, {"i": "7"}, "x" * 5000)  # fmt: skip


def damaged_bytes(data, generator):
    data = bytearray(data)
    for _ in range(generator.choice((1, 1, 1, 2, 3, 8))):
        place = generator.randrange(max(1, len(data) - 8))
        kind = generator.randrange(6)
        if kind == 0:
            data[place] ^= 1 << generator.randrange(8)
        elif kind == 1:
            data[place] = generator.randrange(256)
        elif kind == 2:  # a number or an offset
            place -= place % 4
            data[place : place + 4] = (generator.choice(NUMBERS) & 0xFFFFFFFF).to_bytes(4, "little")
        elif kind == 3:  # an offset to another place
            place -= place % 4
            data[place : place + 4] = generator.randrange(len(data)).to_bytes(4, "little")
        elif kind == 4:
            start, length = generator.randrange(len(data)), generator.randrange(1, 64)
            data[place : place + length] = data[start : start + length]
        elif generator.random() < 0.2:
            del data[generator.randrange(len(data)) :]
            data += bytes(8)
    return bytes(data)


def damaged_tree(tree, generator):
    """Another value somewhere in the objects and lists of a JSON file."""
    place = tree
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        if not keys:
            return tree
        key = generator.choice(keys)
        below = place[key]
        if not isinstance(below, (dict, list)) or not below or generator.random() < 0.1:
            break
        place = below
    kind = generator.randrange(4)
    if kind == 0:
        del place[key]
    elif kind == 1 and isinstance(place, list):
        place.append(place[generator.randrange(len(place))])
    elif kind == 2 and isinstance(place, dict):
        place[generator.choice(keys)] = below
    else:
        place[key] = generator.choice(VALUES)
    return tree


class Lite:
    name = "TensorFlow Lite"

    def __init__(self, _folder):
        self._data = TinyLite().bytes()

    def make(self, generator):
        return damaged_bytes(self._data, generator)

    def convert(self, data):
        return person_mask.convert(reader.read_model(data))


class Js:
    name = "TensorFlow.js"

    def __init__(self, folder):
        graph = SmallGraph()
        self._text, self._weights = json.dumps(graph.json()), graph.data
        self._json, self._bin = folder / "graph.json", folder / "weights.bin"
        self._bin.write_bytes(self._weights)

    def make(self, generator):
        if generator.random() < 0.3:
            return damaged_bytes(self._text.encode(), generator)
        tree = json.loads(self._text)
        for _ in range(generator.choice((1, 1, 2, 4))):
            damaged_tree(tree, generator)
        return json.dumps(tree).encode()

    def convert(self, data):
        self._json.write_bytes(data)
        return convert_nanodet(load_graph_model(self._json, self._bin))


def failure_of(target, data):
    """Why an input is a failure, empty when it is none; and whether it was converted."""
    start = time.process_time()  # of the CPU: the machine may be busy
    converted = False
    try:
        target.convert(data)
        converted = True
    except ConversionError:
        pass
    except Exception as error:  # what the driver is there for
        return f"{type(error).__name__}: {error}", converted
    seconds = time.process_time() - start
    if seconds > MOST_SECONDS:
        return f"took {seconds:.1f} s", converted
    memory_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return (f"{memory_mib:.0f} MiB of memory" if memory_mib > MOST_MEMORY_MIB else ""), converted


def fuzz(target, inputs, seed):
    generator = random.Random(seed)
    converted = 0
    for i in range(inputs):
        data = target.make(generator)
        failure, whole = failure_of(target, data)
        converted += whole
        if failure:
            pathlib.Path("fuzz_converters.failed").write_bytes(data)
            print(f"{target.name}: input {i} of seed {seed}: {failure}", file=sys.stderr)
            return False
    print(f"{target.name}: {inputs} inputs, all well ({converted} converted, {inputs - converted} refused)")
    return True


def main(arguments):
    inputs = int(arguments[0]) if arguments else 500
    seed = int(arguments[1]) if len(arguments) > 1 else 1
    with tempfile.TemporaryDirectory() as folder:
        targets = [kind(pathlib.Path(folder)) for kind in (Lite, Js)]
        return 0 if all([fuzz(target, inputs, seed) for target in targets]) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
