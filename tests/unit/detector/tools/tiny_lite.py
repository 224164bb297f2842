# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""A small network for masks as a TensorFlow Lite file, with each operator that the real one has."""

import struct

import numpy as np

FLOAT, HALF, INT = 0, 1, 2
CODES = {"ADD": 0, "AVERAGE_POOL_2D": 1, "CONV_2D": 3, "DEPTHWISE_CONV_2D": 4, "DEQUANTIZE": 6, "LOGISTIC": 14,
         "MUL": 18, "RELU": 19, "RESIZE_BILINEAR": 23, "CUSTOM": 32, "HARD_SWISH": 117}  # fmt: skip
SAME, VALID, RELU = 0, 1, 1
SIDE, PLANES = 8, 4


class FlatBuffer:
    """Writes tables. A field is None or (kind, value)."""

    def __init__(self, identifier):
        self.data = bytearray(4) + identifier

    def finish(self, fields):
        self._put(0, "<I", self._table(fields))
        return bytes(self.data)

    def _put(self, place, layout, value):
        struct.pack_into(layout, self.data, place, value)

    def _table(self, fields):
        self.data += bytes(-len(self.data) % 4)
        vtable = len(self.data)
        slots = [4 + 4 * i if field is not None else 0 for i, field in enumerate(fields)]
        self.data += struct.pack(f"<{2 + len(slots)}H", 4 + 2 * len(slots), 4 + 4 * len(slots), *slots)
        self.data += bytes(-len(self.data) % 4)
        table = len(self.data)
        self.data += bytes(4 + 4 * len(fields))
        self._put(table, "<i", table - vtable)
        for slot, field in zip(slots, fields):
            if field is not None:
                self._field(table + slot, *field)
        return table

    def _field(self, place, kind, value):
        if kind in ("<b", "<i", "<I"):
            self._put(place, kind, value)
        elif kind == "table":
            self._put(place, "<I", self._table(value) - place)
        elif kind == "tables":
            start = self._vector(place, len(value), bytes(4 * len(value)))
            for i, fields in enumerate(value):
                self._put(start + 4 * i, "<I", self._table(fields) - start - 4 * i)
        elif kind == "integers":
            self._vector(place, len(value), struct.pack(f"<{len(value)}i", *value))
        else:
            self._vector(place, len(value), value)

    def _vector(self, place, count, content):
        self.data += bytes(-len(self.data) % 4)
        self._put(place, "<I", len(self.data) - place)
        self.data += struct.pack("<I", count) + content
        return len(self.data) - len(content)


class TinyLite:
    """Attributes may be changed before bytes() is asked for: tensors (shape, type, buffer), operators (name, inputs,
    outputs, options, custom options)."""

    def __init__(self):
        self.random = np.random.default_rng(5)
        self.tensors, self.buffers, self.operators = [], [b""], []
        image = self.tensor((1, SIDE, SIDE, 3))
        first = self.swish(self.conv(image, PLANES, 3, 2, SAME))
        deep = self.relu(self.depthwise(first))
        gate = self.sigmoid(self.conv(self.pool(deep), PLANES, 1, 1, VALID))
        joined = self.add(self.operator("MUL", [deep, gate], self.shape(deep), [None]), first)
        small = self.conv(joined, PLANES, 2, 2, VALID, RELU)
        joined = self.add(joined, self.resize(small, self.shape(joined)[1]))
        self.inputs, self.outputs = [image], [self.sigmoid(self.transposed(joined))]

    def tensor(self, shape, kind=FLOAT, content=b""):
        if content:
            self.buffers.append(content)
        self.tensors.append([list(shape), kind, len(self.buffers) - 1 if content else 0])
        return len(self.tensors) - 1

    def shape(self, tensor):
        return self.tensors[tensor][0]

    def operator(self, name, inputs, shape, options=None, custom=b""):
        output = self.tensor(shape)
        self.operators.append([name, list(inputs), [output], options, custom])
        return output

    def weight(self, shape):
        """Stored by halves, as those of the real network."""
        values = (0.5 * self.random.normal(size=shape)).astype("<f2")
        return self.operator("DEQUANTIZE", [self.tensor(shape, HALF, values.tobytes())], shape)

    def conv(self, image, planes, kernel, stride, padding, activation=0):
        _, height, width, depth = self.shape(image)
        inputs = [image, self.weight((planes, kernel, kernel, depth)), self.weight((planes,))]
        options = [("<b", padding), ("<i", stride), ("<i", stride), ("<b", activation)]
        return self.operator("CONV_2D", inputs, (1, height // stride, width // stride, planes), options)

    def depthwise(self, image):
        planes = self.shape(image)[3]
        options = [("<b", SAME), ("<i", 1), ("<i", 1), ("<i", 1), ("<b", 0)]
        inputs = [image, self.weight((1, 3, 3, planes)), self.weight((planes,))]
        return self.operator("DEPTHWISE_CONV_2D", inputs, self.shape(image), options)

    def pool(self, image):
        side, planes = self.shape(image)[1], self.shape(image)[3]
        options = [("<b", VALID), ("<i", side), ("<i", side), ("<i", side), ("<i", side), None]
        return self.operator("AVERAGE_POOL_2D", [image], (1, 1, 1, planes), options)

    def resize(self, image, side):
        sizes = self.tensor((2,), INT, struct.pack("<ii", side, side))
        shape = (1, side, side, self.shape(image)[3])
        return self.operator("RESIZE_BILINEAR", [image, sizes], shape, [None, None, None, ("<b", 1)])

    def transposed(self, image):
        _, height, width, depth = self.shape(image)
        inputs = [image, self.weight((1, 2, 2, depth)), self.weight((1,))]
        return self.operator("CUSTOM", inputs, (1, 2 * height, 2 * width, 1), custom=struct.pack("<iii", VALID, 2, 2))

    def add(self, first, second):
        return self.operator("ADD", [first, second], self.shape(first), [("<b", 0)])

    def swish(self, image):
        return self.operator("HARD_SWISH", [image], self.shape(image))

    def relu(self, image):
        return self.operator("RELU", [image], self.shape(image))

    def sigmoid(self, image):
        return self.operator("LOGISTIC", [image], self.shape(image))

    def bytes(self):
        names = sorted({operator[0] for operator in self.operators})
        codes = []
        for name in names:
            code = CODES.get(name, 99)
            custom = ("text", b"Convolution2DTransposeBias") if name == "CUSTOM" else None
            codes.append([("<b", code), custom, None, ("<i", code)])
        tensors = [[("integers", shape), ("<b", kind), ("<I", buffer), ("text", b"t")]
                   for shape, kind, buffer in self.tensors]  # fmt: skip
        operators = []
        for name, inputs, outputs, options, custom in self.operators:
            fields = [("<I", names.index(name)), ("integers", inputs), ("integers", outputs), None, None, None]
            if options is not None:
                fields[3:5] = [("<b", 1), ("table", options)]
            if custom:
                fields[5] = ("bytes", custom)
            operators.append(fields)
        graph = [("tables", tensors), ("integers", self.inputs), ("integers", self.outputs), ("tables", operators)]
        buffers = [[("bytes", content)] if content else [None] for content in self.buffers]
        model = [("<I", 3), ("tables", codes), ("tables", [graph]), None, ("tables", buffers)]
        return FlatBuffer(b"TFL3").finish(model)
