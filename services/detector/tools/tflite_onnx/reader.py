# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Reads a TensorFlow Lite file: tensors, operators and weights of its one graph. The numbers of fields and operators
are those of the public schema (tensorflow/lite/schema/schema.fbs)."""

import math

import numpy as np

from yolov5_onnx.errors import ConversionError, read_bytes

from .flatbuffer import root_table

IDENTIFIER = b"TFL3"
MAX_FILE_BYTES = 16 << 20
MAX_SIDE = 4096
MAX_ELEMENTS = 1 << 26  # of a tensor
ITEM_TYPES = {0: "<f4", 1: "<f2", 2: "<i4"}
CUSTOM = 32
OPERATORS = {
    0: "ADD",
    1: "AVERAGE_POOL_2D",
    3: "CONV_2D",
    4: "DEPTHWISE_CONV_2D",
    6: "DEQUANTIZE",
    14: "LOGISTIC",
    18: "MUL",
    19: "RELU",
    23: "RESIZE_BILINEAR",
    117: "HARD_SWISH",
}


class Tensor:
    """Shape and, of a constant, its bytes."""

    def __init__(self, table, buffers):
        self.name = table.text(3)
        self.shape = tuple(table.integers(0))
        if len(self.shape) > 4 or not all(0 < side <= MAX_SIDE for side in self.shape):
            raise ConversionError(f"the tensor '{self.name}' has the shape {list(self.shape)}")
        if math.prod(self.shape) > MAX_ELEMENTS:
            raise ConversionError(f"the tensor '{self.name}' has {math.prod(self.shape)} numbers")
        self._type = table.integer(1, "<b")
        buffer = table.integer(2, "<I")
        if buffer >= len(buffers):
            raise ConversionError(f"the tensor '{self.name}' is in buffer {buffer} of {len(buffers)}")
        self._bytes = buffers[buffer]

    @property
    def constant(self):
        return len(self._bytes) > 0

    def values(self):
        """The numbers of a constant, of 32 bits each."""
        if self._type not in ITEM_TYPES:
            raise ConversionError(f"the tensor '{self.name}' is of type {self._type}, which this reader does not know")
        stored = np.dtype(ITEM_TYPES[self._type])
        if math.prod(self.shape) * stored.itemsize != len(self._bytes):
            raise ConversionError(f"the tensor '{self.name}' of shape {list(self.shape)} has {len(self._bytes)} bytes")
        values = np.frombuffer(self._bytes, stored).reshape(self.shape)
        return values.astype(np.int32 if stored.kind == "i" else np.float32)


class Operator:
    """`inputs` and `outputs` are numbers of tensors, -1 for one that is left out; `options` is a table or None."""

    def __init__(self, table, codes):
        code = table.integer(0, "<I")
        if code >= len(codes):
            raise ConversionError(f"an operator is of kind {code} of {len(codes)}")
        self.name = codes[code]
        self.inputs, self.outputs = table.integers(1), table.integers(2)
        self.options = table.table(4)
        self.custom_options = bytes(table.bytes(5)[:64])

    def option(self, field, layout, default=0):
        return self.options.integer(field, layout, default) if self.options else default


class LiteModel:
    def __init__(self, data):
        model = root_table(data)
        codes = [operator_name(code) for code in model.tables(1)]
        buffers = [buffer.bytes(0) for buffer in model.tables(4)]
        graphs = model.tables(2)
        if len(graphs) != 1:
            raise ConversionError(f"there are {len(graphs)} graphs, expected one")
        self.tensors = [Tensor(tensor, buffers) for tensor in graphs[0].tables(0)]
        self.inputs, self.outputs = graphs[0].integers(1), graphs[0].integers(2)
        self.operators = [Operator(operator, codes) for operator in graphs[0].tables(3)]

    def tensor(self, index):
        if not 0 <= index < len(self.tensors):
            raise ConversionError(f"there is no tensor {index}, there are {len(self.tensors)}")
        return self.tensors[index]


def operator_name(table):
    """Small codes are in the older field, which has one byte."""
    code = max(table.integer(0, "<b"), table.integer(3, "<i"))
    return f"'{table.text(1)}'" if code == CUSTOM else OPERATORS.get(code, f"operator {code}")


def read_model(data):
    """Raises ConversionError for bytes that are no such file, or a damaged one."""
    if len(data) < 8 or data[4:8] != IDENTIFIER:
        raise ConversionError("is not a TensorFlow Lite file, or truncated")
    return LiteModel(memoryview(data))


def load_model(path):
    data = read_bytes(path, MAX_FILE_BYTES)
    try:
        return read_model(data)
    except ConversionError as error:
        raise ConversionError(f"{path}: {error}") from error
