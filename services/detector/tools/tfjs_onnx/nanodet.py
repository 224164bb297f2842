# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The layers of NanoDet, from TensorFlow's order of dimensions (N, H, W, C) to ONNX's (N, C, H, W).

Transposes vanish: each tensor is kept as N, C, H, W with the note which of these its dimensions are in TensorFlow.
Paddings vanish too: they become those of the layer that follows.
"""

import numpy as np

from yolov5_onnx.errors import ConversionError
from yolov5_onnx.graph import Graph

CHANNELS_LAST = (0, 2, 3, 1)
NO_PADS = (0,) * 8
LEAST = -65504.0  # of half precision; often minus infinity
# What computes the boxes behind the heads: the detector does that itself.
BEHIND_THE_HEADS = {"Const", "Identity", "SparseToDense", "AddV2", "Reshape", "Sigmoid"}


class Tensor:
    """A tensor of the ONNX graph; `order[i]` is where TensorFlow's dimension i lies in N, C, H, W. `pads` are still to
    be added, by zeros or by the least number."""

    def __init__(self, name, order, pads=NO_PADS, by_zeros=True):
        self.name, self.order, self.pads, self.by_zeros = name, tuple(order), pads, by_zeros


class Converter:
    def __init__(self, model):
        self._weights = model.weights
        self._nodes = model.nodes
        self._tensors = {}
        self._bias_nodes = self._find_biases()  # convolution -> the Add behind it
        self.heads = []
        self.classes = 0
        self.graph = None

    def run(self):
        """Fills graph and heads."""
        for node in self._nodes:
            if node.operator in BEHIND_THE_HEADS:
                continue
            method = getattr(self, "_" + node.operator.lower(), None)
            if method is None:
                raise ConversionError(f"'{node.name}': the operator {node.operator} is not one of NanoDet's")
            tensor = method(node)
            if tensor is not None:
                self._tensors[node.name] = tensor

    def _find_biases(self):
        """The Adds of weights to convolutions that nothing else takes."""
        users = {}
        for node in self._nodes:
            for name in node.inputs:
                users.setdefault(name, []).append(node)
        biases = {}
        for node in self._nodes:
            followers = users.get(node.name, [])
            if node.operator != "Conv2D" or len(followers) != 1:
                continue
            add = followers[0]
            if add.operator == "Add" and len(add.inputs) == 2 and add.inputs[1] in self._weights:
                biases[node.name] = add
        return biases

    def _tensor(self, node, index):
        name = self._input(node, index)
        if name not in self._tensors:
            raise ConversionError(f"'{node.name}' ({node.operator}) takes '{name}', which is not computed before it")
        return self._tensors[name]

    def _input(self, node, index):
        if index >= len(node.inputs):
            raise ConversionError(f"'{node.name}' ({node.operator}) has {len(node.inputs)} inputs")
        return node.inputs[index]

    def _weight(self, node, index, dimensions):
        name = self._input(node, index)
        if name not in self._weights:
            raise ConversionError(f"'{node.name}' ({node.operator}) takes the weight '{name}', which is not there")
        values = self._weights[name]
        if values.ndim != dimensions:
            raise ConversionError(f"'{node.name}' ({node.operator}): '{name}' has {values.ndim} dimensions")
        if not np.isfinite(values).all():
            raise ConversionError(f"'{node.name}' ({node.operator}): '{name}' has numbers that are infinite or none")
        return values

    def _image(self, node):
        """The first input, channels last."""
        tensor = self._tensor(node, 0)
        if tensor.order != CHANNELS_LAST:
            raise ConversionError(f"'{node.name}' ({node.operator}) takes no tensor of N, H, W, C")
        return tensor

    def _unpadded(self, node, index):
        tensor = self._tensor(node, index)
        if tensor.pads != NO_PADS:
            raise ConversionError(f"'{node.name}' ({node.operator}) takes a padded tensor")
        return tensor

    def _placeholder(self, node):
        if self.graph is not None:
            raise ConversionError(f"'{node.name}': there is a second input")
        entries = node.attribute("shape", "shape", "dim")
        sizes = [int(entry["size"]) for entry in entries]
        if len(sizes) != 4 or sizes[:2] != [1, 3] or not all(0 < size <= 4096 for size in sizes):
            raise ConversionError(f"'{node.name}': the input {sizes} is not 1, 3, H, W")
        self.graph = Graph("images", sizes)
        return Tensor("images", (0, 1, 2, 3))

    def _transpose(self, node):
        if self._input(node, 0) not in self._tensors:
            return None  # behind the heads
        tensor = self._tensor(node, 0)
        order = self._weight(node, 1, 1).tolist()
        if sorted(order) != [0, 1, 2, 3]:
            raise ConversionError(f"'{node.name}' (Transpose) has the order {order}")
        return Tensor(tensor.name, [tensor.order[i] for i in order], tensor.pads, tensor.by_zeros)

    def _pad(self, node, by_zeros=True):
        tensor = self._unpadded(node, 0)
        amounts = self._weight(node, 1, 2)
        if amounts.shape != (4, 2) or amounts.min() < 0 or amounts.max() > 64:
            raise ConversionError(f"'{node.name}' ({node.operator}) pads by {amounts.tolist()}")
        pads = [0] * 8
        for dimension, (before, after) in enumerate(amounts.tolist()):
            pads[tensor.order[dimension]], pads[4 + tensor.order[dimension]] = before, after
        if pads[0] or pads[1] or pads[4] or pads[5]:
            raise ConversionError(f"'{node.name}' ({node.operator}) pads images or channels")
        return Tensor(tensor.name, tensor.order, tuple(pads), by_zeros)

    def _padv2(self, node):
        """By the least number, as ONNX pads a MaxPool."""
        value = self._weights.get(self._input(node, 2), np.zeros(1))
        if value.size != 1 or not float(value.reshape(-1)[0]) <= LEAST:
            raise ConversionError(f"'{node.name}' (PadV2) does not pad by the least number")
        return self._pad(node, by_zeros=False)

    def _window(self, node, sides):
        """Strides, paddings and the size of the output of a window of these sides."""
        if node.attribute("padding", "s") != "VkFMSUQ=":  # VALID
            raise ConversionError(f"'{node.name}' ({node.operator}) pads by itself")
        strides = node.integers("strides")
        if len(strides) != 4 or strides[0] != 1 or strides[3] != 1 or min(strides) < 1:
            raise ConversionError(f"'{node.name}' ({node.operator}) has the strides {strides}")
        tensor = self._image(node)
        if tensor.pads != NO_PADS and tensor.by_zeros == (node.operator == "MaxPool"):
            raise ConversionError(f"'{node.name}' ({node.operator}) is padded by a number that ONNX does not pad by")
        pads = [tensor.pads[i] for i in (2, 3, 6, 7)]
        shape = self.graph.shape(tensor.name)
        sizes = [(shape[2 + i] + pads[i] + pads[2 + i] - sides[i]) // strides[1 + i] + 1 for i in (0, 1)]
        return tensor, {"kernel_shape": list(sides), "strides": strides[1:3], "pads": pads}, sizes

    def _conv2d(self, node):
        weights = self._weight(node, 1, 4)
        if any(side != 1 for side in node.integers("dilations")):
            raise ConversionError(f"'{node.name}' (Conv2D) is dilated")
        tensor, attributes, sizes = self._window(node, weights.shape[:2])
        if self.graph.shape(tensor.name)[1] != weights.shape[2]:
            raise ConversionError(f"'{node.name}' (Conv2D) has weights for {weights.shape[2]} channels")
        inputs = [tensor.name, self.graph.constant(weights.transpose(3, 2, 0, 1).astype(np.float32))]
        if node.name in self._bias_nodes:
            bias = self._weight(self._bias_nodes[node.name], 1, 1)
            if bias.shape != (weights.shape[3],):
                raise ConversionError(f"'{node.name}' (Conv2D) has {bias.size} biases for {weights.shape[3]} channels")
            inputs.append(self.graph.constant(bias.astype(np.float32)))
        shape = (1, weights.shape[3], *sizes)
        return Tensor(self.graph.add("Conv", inputs, shape, **attributes), CHANNELS_LAST)

    def _maxpool(self, node):
        window = node.integers("ksize")
        if len(window) != 4 or window[0] != 1 or window[3] != 1:
            raise ConversionError(f"'{node.name}' (MaxPool) has the window {window}")
        tensor, attributes, sizes = self._window(node, window[1:3])
        shape = (1, self.graph.shape(tensor.name)[1], *sizes)
        return Tensor(self.graph.add("MaxPool", [tensor.name], shape, **attributes), CHANNELS_LAST)

    def _add(self, node):
        first = self._unpadded(node, 0)
        shape = self.graph.shape(first.name)
        if self._bias_nodes.get(self._input(node, 0)) is node:
            return first  # the convolution has it
        second = self._unpadded(node, 1)
        if first.order != second.order or shape != self.graph.shape(second.name):
            raise ConversionError(f"'{node.name}' (Add) adds tensors of different shapes")
        return Tensor(self.graph.add("Add", [first.name, second.name], shape), first.order)

    def _leakyrelu(self, node):
        tensor = self._unpadded(node, 0)
        slope = float(node.attribute("alpha", "f"))
        shape = self.graph.shape(tensor.name)
        return Tensor(self.graph.add("LeakyRelu", [tensor.name], shape, alpha=slope), tensor.order)

    def _concatv2(self, node):
        parts = [self._unpadded(node, i) for i in range(len(node.inputs) - 1)]
        axis = int(self._weight(node, len(node.inputs) - 1, 0))
        if not parts or not -4 <= axis < 4 or any(part.order != parts[0].order for part in parts):
            raise ConversionError(f"'{node.name}' (ConcatV2) joins tensors of different kinds")
        shapes = [self.graph.shape(part.name) for part in parts]
        if parts[0].order[axis] != 1 or any(s[0] != 1 or s[2:] != shapes[0][2:] for s in shapes):
            raise ConversionError(f"'{node.name}' (ConcatV2) does not join channels of one size")
        shape = (1, sum(s[1] for s in shapes), *shapes[0][2:])
        return Tensor(self.graph.add("Concat", [part.name for part in parts], shape, axis=1), parts[0].order)

    def _resizebilinear(self, node):
        tensor = self._image(node)
        sizes = self._weight(node, 1, 1).tolist()
        if node.attribute("half_pixel_centers", "b") is not True or len(sizes) != 2:
            raise ConversionError(f"'{node.name}' (ResizeBilinear) is of another kind")
        old = self.graph.shape(tensor.name)
        scales = np.array([1, 1, sizes[0] / old[2], sizes[1] / old[3]], np.float32)
        inputs = [tensor.name, self.graph.constant(np.zeros(0, np.float32)), self.graph.constant(scales)]
        kind = {"mode": "linear", "coordinate_transformation_mode": "half_pixel"}
        return Tensor(self.graph.add("Resize", inputs, (1, old[1], *sizes), **kind), CHANNELS_LAST)

    def _splitv(self, node):
        """What is split into classes and distances is a head."""
        tensor = self._unpadded(node, 0)
        sizes, axis = self._weight(node, 1, 1).tolist(), int(self._weight(node, 2, 0))
        planes = self.graph.shape(tensor.name)[1]
        if len(sizes) != 2 or not -4 <= axis < 4 or tensor.order[axis] != 1 or sum(sizes) != planes or sizes[1] % 4:
            raise ConversionError(f"'{node.name}' (SplitV) does not split {planes} channels into classes and distances")
        if self.heads and self.classes != sizes[0]:
            raise ConversionError(f"'{node.name}' (SplitV) has {sizes[0]} classes, another head has {self.classes}")
        self.classes = sizes[0]
        self.heads.append(tensor.name)


def convert(model):
    """The ONNX model and its number of parameters. One output for each stride, `stride_8` to `stride_32`."""
    converter = Converter(model)
    try:
        converter.run()
    except (TypeError, ValueError, KeyError, IndexError, OverflowError) as error:
        raise ConversionError(f"the graph is damaged: {error}") from error
    if len(converter.heads) != 3:
        raise ConversionError(f"the graph has {len(converter.heads)} heads, NanoDet has three")
    height = converter.graph.shape("images")[2]
    names = {head: f"stride_{height // converter.graph.shape(head)[2]}" for head in converter.heads}
    if sorted(names.values()) != ["stride_16", "stride_32", "stride_8"]:
        raise ConversionError(f"the heads have {', '.join(names.values())}, NanoDet's have 8, 16 and 32")
    metadata = {"rtd.decoder": "nanodet", "rtd.class_count": str(converter.classes)}
    onnx_model = converter.graph.to_model(names, metadata, "nanodet")
    return onnx_model, converter.graph.parameter_count()
