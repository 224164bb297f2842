# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Reads a graph model of TensorFlow.js: nodes from its JSON file, weights from its binary file."""

import json
import math

import numpy as np

from yolov5_onnx.errors import ConversionError, read_bytes

MAX_JSON_BYTES = 4 << 20
MAX_WEIGHT_BYTES = 64 << 20
MAX_SIDE = 1 << 20
ITEM_TYPES = {"float16": "<f2", "float32": "<f4", "int32": "<i4"}


class Node:
    """A node of the graph: name, operator, inputs without their output numbers, attributes."""

    def __init__(self, entry, where):
        self.name = text_of(entry, "name", where)
        self.operator = text_of(entry, "op", where)
        inputs = entry.get("input", [])
        if not isinstance(inputs, list) or not all(isinstance(name, str) for name in inputs):
            raise ConversionError(f"{where}: the inputs of '{self.name}' are not names")
        self.inputs = [name[:-2] if name.endswith(":0") else name for name in inputs]
        self.attributes = entry.get("attr", {})
        if not isinstance(self.attributes, dict):
            raise ConversionError(f"{where}: the attributes of '{self.name}' are not an object")

    def attribute(self, *path):
        """attribute("alpha", "f"); an error when it is not there."""
        value = self.attributes
        for key in path:
            if not isinstance(value, dict) or key not in value:
                raise ConversionError(f"'{self.name}' ({self.operator}) has no attribute {'.'.join(path)}")
            value = value[key]
        return value

    def integers(self, name):
        """A list of whole numbers, e.g. the strides."""
        values = self.attribute(name, "list", "i")
        try:
            return [int(value) for value in values]
        except (TypeError, ValueError) as error:
            raise ConversionError(f"'{self.name}' ({self.operator}): {name} is not a list of numbers") from error


class GraphModel:
    """Nodes in the order of the file and weights by name."""

    def __init__(self, nodes, weights):
        self.nodes = nodes
        self.weights = weights


def text_of(entry, key, where):
    if not isinstance(entry, dict) or not isinstance(entry.get(key), str):
        raise ConversionError(f"{where}: an entry has no text '{key}'")
    return entry[key]


def list_of(entry, key, where):
    if not isinstance(entry, dict) or not isinstance(entry.get(key), list):
        raise ConversionError(f"{where}: there is no list '{key}'")
    return entry[key]


def load_graph_model(json_path, weights_path):
    """Reads both files. Every length and shape must fit: raises ConversionError with the file otherwise."""
    try:
        model = json.loads(read_bytes(json_path, MAX_JSON_BYTES))
    except (ValueError, RecursionError) as error:
        raise ConversionError(f"{json_path}: is not JSON, or truncated") from error
    if not isinstance(model, dict) or model.get("format") != "graph-model":
        raise ConversionError(f"{json_path}: is not a graph model of TensorFlow.js")
    entries = list_of(model.get("modelTopology"), "node", json_path)
    nodes = [Node(entry, json_path) for entry in entries]
    return GraphModel(nodes, read_weights(list_of(model, "weightsManifest", json_path), weights_path, json_path))


def read_weights(manifest, weights_path, json_path):
    """The weights of all groups, which lie in one file, one after the other."""
    data = memoryview(read_bytes(weights_path, MAX_WEIGHT_BYTES))
    weights, offset = {}, 0
    for group in manifest:
        for entry in list_of(group, "weights", json_path):
            name = text_of(entry, "name", json_path)
            if name in weights:
                raise ConversionError(f"{json_path}: there are two weights '{name}'")
            weights[name], offset = take_weight(entry, data, offset, json_path, weights_path)
    if offset != len(data):
        raise ConversionError(f"{weights_path}: {len(data)} bytes, but {json_path} describes {offset}")
    return weights


def take_weight(entry, data, offset, json_path, weights_path):
    name = entry["name"]
    shape = list_of(entry, "shape", json_path)
    if not all(type(side) is int and 0 <= side <= MAX_SIDE for side in shape):
        raise ConversionError(f"{json_path}: '{name}' has the shape {shape}")
    stored = np.dtype(item_type(entry, json_path))
    size = math.prod(shape) * stored.itemsize  # of Python: never overflows
    if size > len(data) - offset:
        raise ConversionError(f"{weights_path}: truncated: '{name}' needs bytes {offset} to {offset + size}, "
                              f"there are {len(data)}")
    values = np.frombuffer(data[offset : offset + size], stored).reshape(shape)
    return values.astype(np.int64 if stored.kind == "i" else np.float32), offset + size


def item_type(entry, json_path):
    """How a weight is stored. Floats may be halved; scaled whole numbers are not read."""
    kind = text_of(entry, "dtype", json_path)
    quantization = entry.get("quantization")
    if quantization is not None:
        kind = text_of(quantization, "dtype", json_path) if kind == "float32" else ""
        if kind != "float16":
            kind = ""
    if kind not in ITEM_TYPES:
        raise ConversionError(f"{json_path}: '{entry['name']}' is stored in a way that this reader does not know")
    return ITEM_TYPES[kind]
