# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The layers of a network for person masks, from TensorFlow Lite's order (N, H, W, C) to ONNX's (N, C, H, W)."""

import struct

import numpy as np

from yolov5_onnx.errors import ConversionError
from yolov5_onnx.graph import Graph

INPUT, OUTPUT = "images", "person"
MAX_WEIGHTS = 1 << 24  # of all layers together; the network has 106 thousand
SAME, VALID = 0, 1
NO_ACTIVATION, RELU = 0, 1
TRANSPOSED_CONVOLUTION = "'Convolution2DTransposeBias'"  # of MediaPipe


class Converter:
    def __init__(self, model):
        self._model = model
        self._names = {}  # number of a tensor -> its name in the graph
        self._weights = {}  # number of a tensor that a DEQUANTIZE gives -> that of the constant
        self._count = 0
        self.graph = None

    def run(self):
        """Fills graph; gives the name of its output."""
        model = self._model
        shape = model.tensor(model.inputs[0]).shape if len(model.inputs) == 1 else ()
        if len(shape) != 4 or shape[0] != 1 or shape[3] != 3:
            raise ConversionError(f"the input {list(shape)} is not one image 1, H, W, 3")
        self.graph = Graph(INPUT, (1, 3, shape[1], shape[2]))
        self._names[model.inputs[0]] = INPUT
        for operator in model.operators:
            self._convert(operator)
        if len(model.outputs) != 1 or model.outputs[0] not in self._names:
            raise ConversionError(f"there are {len(model.outputs)} outputs, expected one that is computed")
        output = self._names[model.outputs[0]]
        if self.graph.shape(output) != (1, 1, shape[1], shape[2]):
            raise ConversionError(f"the output has the shape {self.graph.shape(output)}, not that of a mask")
        return output

    def _convert(self, operator):
        if len(operator.outputs) != 1:
            raise ConversionError(f"{operator.name} has {len(operator.outputs)} outputs")
        if operator.name == "DEQUANTIZE":  # of weights: from half to single precision
            self._weights[operator.outputs[0]] = self._input(operator, 0)
            return
        method = self._METHODS.get(operator.name)
        if method is None:
            raise ConversionError(f"{operator.name} is not one of the operators of a network for masks")
        if operator.outputs[0] in self._names:
            raise ConversionError(f"tensor {operator.outputs[0]} is computed twice")
        name = method(self, operator)
        found, said = self.graph.shape(name), self._model.tensor(operator.outputs[0]).shape
        if len(said) != 4 or tuple(said[i] for i in (0, 3, 1, 2)) != found:
            raise ConversionError(f"{operator.name} gives {list(said)}, its inputs give N, C, H, W = {list(found)}")
        self._names[operator.outputs[0]] = name

    def _input(self, operator, index):
        if index >= len(operator.inputs):
            raise ConversionError(f"{operator.name} has {len(operator.inputs)} inputs")
        return operator.inputs[index]

    def _tensor(self, operator, index):
        number = self._input(operator, index)
        if number not in self._names:
            raise ConversionError(f"{operator.name} takes tensor {number}, which is not computed before it")
        return self._names[number]

    def _values(self, operator, index, dimensions):
        number = self._input(operator, index)
        tensor = self._model.tensor(self._weights.get(number, number))
        if not tensor.constant or len(tensor.shape) != dimensions:
            raise ConversionError(f"{operator.name} takes '{tensor.name}', not values in {dimensions} dimensions")
        values = tensor.values()
        if not np.isfinite(values).all():
            raise ConversionError(f"{operator.name}: '{tensor.name}' has numbers that are infinite or none")
        self._count += values.size
        if self._count > MAX_WEIGHTS:
            raise ConversionError(f"the layers have more than {MAX_WEIGHTS} weights together")
        return values

    def _activated(self, name, activation):
        if activation == NO_ACTIVATION:
            return name
        if activation == RELU:
            return self.graph.add("Relu", [name], self.graph.shape(name))
        raise ConversionError(f"the activation {activation} is not one of a network for masks")

    def _conv_2d(self, operator):
        weights = self._values(operator, 1, 4)  # O, H, W, I
        return self._convolve(operator, weights.transpose(0, 3, 1, 2), 1, 3, 4)

    def _depthwise_conv_2d(self, operator):
        weights = self._values(operator, 1, 4)  # 1, H, W, O
        planes = self.graph.shape(self._tensor(operator, 0))[1]
        if weights.shape[0] != 1 or weights.shape[3] != planes:
            raise ConversionError(f"{operator.name} has weights {list(weights.shape)} for {planes} channels")
        return self._convolve(operator, weights.transpose(3, 0, 1, 2), planes, 4, 5)

    def _convolve(self, operator, weights, groups, activation_field, dilation_field):
        """`weights` are O, I of a group, H, W."""
        name = self._tensor(operator, 0)
        shape = self.graph.shape(name)
        if weights.shape[1] * groups != shape[1]:
            raise ConversionError(f"{operator.name} has weights for {weights.shape[1]} of {shape[1]} channels")
        if any(operator.option(dilation_field + i, "<i", 1) != 1 for i in (0, 1)):
            raise ConversionError(f"{operator.name} is dilated")
        strides = self._strides(operator)
        pads, sizes = window(operator, shape[2:], weights.shape[2:], strides)
        inputs = [name, self.graph.constant(weights), self._bias(operator, weights.shape[0])]
        attributes = {"kernel_shape": list(weights.shape[2:]), "strides": strides, "pads": pads, "group": groups}
        convolved = self.graph.add("Conv", inputs, (1, weights.shape[0], *sizes), **attributes)
        return self._activated(convolved, operator.option(activation_field, "<b"))

    def _strides(self, operator):
        """Of rows and columns."""
        strides = [operator.option(2, "<i"), operator.option(1, "<i")]
        if not all(0 < stride <= 64 for stride in strides):
            raise ConversionError(f"{operator.name} has the strides {strides}")
        return strides

    def _bias(self, operator, planes):
        bias = self._values(operator, 2, 1)
        if bias.shape != (planes,):
            raise ConversionError(f"{operator.name} has {bias.size} biases for {planes} channels")
        return self.graph.constant(bias)

    def _transposed(self, operator):
        """Its options are three numbers of 32 bits: padding, stride of columns, stride of rows."""
        if len(operator.custom_options) != 12:
            raise ConversionError(f"{operator.name} has {len(operator.custom_options)} bytes of options, expected 12")
        strides = struct.unpack("<iii", operator.custom_options)[2:0:-1]
        name = self._tensor(operator, 0)
        shape = self.graph.shape(name)
        weights = self._values(operator, 1, 4)  # O, H, W, I
        if weights.shape[3] != shape[1] or weights.shape[1:3] != strides:
            raise ConversionError(f"{operator.name} has weights {list(weights.shape)} and strides {list(strides)}")
        inputs = [name, self.graph.constant(weights.transpose(3, 0, 1, 2)), self._bias(operator, weights.shape[0])]
        sizes = (shape[2] * strides[0], shape[3] * strides[1])
        attributes = {"kernel_shape": list(strides), "strides": list(strides)}
        return self.graph.add("ConvTranspose", inputs, (1, weights.shape[0], *sizes), **attributes)

    def _average_pool_2d(self, operator):
        """Only over the whole image."""
        name = self._tensor(operator, 0)
        shape = self.graph.shape(name)
        kernel = (operator.option(4, "<i"), operator.option(3, "<i"))
        if kernel != shape[2:] or operator.option(0, "<b") != VALID:
            raise ConversionError(f"{operator.name} averages over {kernel} of {shape[2:]}")
        mean = self.graph.add("GlobalAveragePool", [name], (*shape[:2], 1, 1))
        return self._activated(mean, operator.option(5, "<b"))

    def _pair(self, operator):
        names = [self._tensor(operator, i) for i in (0, 1)]
        return names, [self.graph.shape(name) for name in names]

    def _add(self, operator):
        names, shapes = self._pair(operator)
        if shapes[0] != shapes[1]:
            raise ConversionError(f"{operator.name} adds {shapes[0]} and {shapes[1]}")
        return self._activated(self.graph.add("Add", names, shapes[0]), operator.option(0, "<b"))

    def _mul(self, operator):
        """By one number for each channel, or by a tensor of the same shape."""
        names, shapes = self._pair(operator)
        if shapes[1] not in (shapes[0], (*shapes[0][:2], 1, 1)):
            raise ConversionError(f"{operator.name} multiplies {shapes[0]} by {shapes[1]}")
        return self._activated(self.graph.add("Mul", names, shapes[0]), operator.option(0, "<b"))

    def _resize_bilinear(self, operator):
        name = self._tensor(operator, 0)
        shape = self.graph.shape(name)
        sizes = self._values(operator, 1, 1).tolist()
        if len(sizes) != 2 or not all(type(size) is int and 0 < size <= 4096 for size in sizes):
            raise ConversionError(f"{operator.name} gives images of {sizes}")
        if operator.option(2, "<b") or not operator.option(3, "<b"):
            raise ConversionError(f"{operator.name} does not keep half pixels")
        scales = np.array([1, 1, sizes[0] / shape[2], sizes[1] / shape[3]], np.float32)
        inputs = [name, self.graph.constant(np.zeros(0, np.float32)), self.graph.constant(scales)]
        kind = {"mode": "linear", "coordinate_transformation_mode": "half_pixel"}
        return self.graph.add("Resize", inputs, (1, shape[1], *sizes), **kind)

    def _relu(self, operator):
        return self._elementwise("Relu", operator)

    def _logistic(self, operator):
        return self._elementwise("Sigmoid", operator)

    def _hard_swish(self, operator):
        """x * min(max(x / 6 + 1 / 2, 0), 1): ONNX has its own operator only from opset 14 on."""
        name = self._tensor(operator, 0)
        gate = self._elementwise("HardSigmoid", operator, alpha=1 / 6, beta=0.5)
        return self.graph.add("Mul", [name, gate], self.graph.shape(name))

    def _elementwise(self, kind, operator, **attributes):
        name = self._tensor(operator, 0)
        return self.graph.add(kind, [name], self.graph.shape(name), **attributes)

    _METHODS = {
        "ADD": _add,
        "AVERAGE_POOL_2D": _average_pool_2d,
        "CONV_2D": _conv_2d,
        "DEPTHWISE_CONV_2D": _depthwise_conv_2d,
        "HARD_SWISH": _hard_swish,
        "LOGISTIC": _logistic,
        "MUL": _mul,
        "RELU": _relu,
        "RESIZE_BILINEAR": _resize_bilinear,
        TRANSPOSED_CONVOLUTION: _transposed,
    }


def window(operator, sizes, kernel, strides):
    """Paddings (before rows, columns, after rows, columns) and sizes of the output."""
    padding = operator.option(0, "<b")
    if padding == VALID:
        return [0] * 4, tuple((size - side) // stride + 1 for size, side, stride in zip(sizes, kernel, strides))
    if padding != SAME:
        raise ConversionError(f"{operator.name} has the padding {padding}")
    outputs = tuple(-(-size // stride) for size, stride in zip(sizes, strides))
    missing = [max((outputs[i] - 1) * strides[i] + kernel[i] - sizes[i], 0) for i in (0, 1)]
    before = [amount // 2 for amount in missing]
    return before + [amount - half for amount, half in zip(missing, before)], outputs


def convert(model, metadata=None):
    """The ONNX model, one input `images` (RGB, 0 to 1) and one output `person` (probability), and its number of
    parameters."""
    converter = Converter(model)
    output = converter.run()
    known = {"rtd.decoder": "person_mask", **(metadata or {})}
    return converter.graph.to_model({output: OUTPUT}, known, "person_mask"), converter.graph.parameter_count()
