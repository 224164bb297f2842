# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The layers of YOLOv5 and YOLOv5-Lite as ONNX nodes, batch normalisation folded into the convolutions.

Each function takes the graph, the name of its input tensor and the layer, and returns the name of its output tensor.
"""

import numpy as np

from .errors import ConversionError


def forward(graph, tensor, layer):
    """Adds a layer of any known type."""
    convert = _LAYERS.get(layer.class_name)
    if convert is None:
        known = ", ".join(sorted(_LAYERS))
        raise ConversionError(f"unknown layer type {layer.class_name}; known are {known}")
    return convert(graph, tensor, layer)


def convolution(graph, tensor, layer, batch_norm=None):
    """Conv2d; a batch normalisation after it is folded into weights and bias."""
    weights = np.asarray(layer.require("weight"), np.float32)
    bias = layer.get("bias")
    bias = None if bias is None else np.asarray(bias, np.float32)
    if batch_norm is not None:
        weights, bias = fold_batch_norm(weights, bias, batch_norm)
    kernel, stride, padding = (_pair(layer.require(name)) for name in ("kernel_size", "stride", "padding"))
    dilation = _pair(layer.get("dilation", 1))
    groups = layer.get("groups", 1)
    batch, channels, height, width = graph.shape(tensor)
    if weights.ndim != 4 or weights.shape[1] * groups != channels:
        raise ConversionError(f"convolution weights {weights.shape} do not fit an input of {channels} channels")
    span = [d * (k - 1) + 1 for d, k in zip(dilation, kernel)]
    rows = (height + 2 * padding[0] - span[0]) // stride[0] + 1
    cols = (width + 2 * padding[1] - span[1]) // stride[1] + 1
    inputs = [tensor, graph.constant(weights)] + ([] if bias is None else [graph.constant(bias)])
    return graph.add(
        "Conv", inputs, (batch, weights.shape[0], rows, cols),
        kernel_shape=kernel, strides=stride, pads=padding + padding, dilations=dilation, group=groups,
    )  # fmt: skip


def fold_batch_norm(weights, bias, batch_norm):
    """y = gamma (conv(x) - mean) / sqrt(variance + eps) + beta, as one convolution."""
    gamma, beta, mean, variance = (
        np.asarray(batch_norm.require(name), np.float64) for name in ("weight", "bias", "running_mean", "running_var")
    )
    scale = gamma / np.sqrt(variance + batch_norm.require("eps"))
    offset = (0.0 if bias is None else bias) - mean
    folded = weights * scale[:, None, None, None]
    return folded.astype(np.float32), (beta + offset * scale).astype(np.float32)


def activation(graph, tensor, layer):
    """SiLU as x * sigmoid(x), the others as their ONNX operator."""
    name, shape = layer.class_name, graph.shape(tensor)
    if name == "SiLU":
        return graph.add("Mul", [tensor, graph.add("Sigmoid", [tensor], shape)], shape)
    if name == "LeakyReLU":
        return graph.add("LeakyRelu", [tensor], shape, alpha=float(layer.get("negative_slope", 0.01)))
    if name == "Hardswish":
        # x * clip(x / 6 + 0.5, 0, 1): the operator HardSwish came only with opset 14
        return graph.add("Mul", [tensor, graph.add("HardSigmoid", [tensor], shape, alpha=1 / 6, beta=0.5)], shape)
    return graph.add("Relu" if name == "ReLU" else "Sigmoid", [tensor], shape)


def identity(_graph, tensor, _layer):
    return tensor


def sequential(graph, tensor, layer):
    """Children in order, each Conv2d with the BatchNorm2d after it."""
    children = layer.children()
    skip = False
    for child, following in zip(children, children[1:] + [None]):
        if skip:
            skip = False
        elif child.class_name == "Conv2d" and following is not None and following.class_name == "BatchNorm2d":
            tensor = convolution(graph, tensor, child, following)
            skip = True
        else:
            tensor = forward(graph, tensor, child)
    return tensor


def conv_block(graph, tensor, layer):
    """Conv, DWConv: convolution, batch normalisation, activation."""
    tensor = convolution(graph, tensor, layer.require("conv"), layer.get("bn"))
    act = layer.get("act")
    return tensor if act is None else forward(graph, tensor, act)


def concat(graph, tensors):
    """Joins tensors along the channels."""
    batch, _, height, width = graph.shape(tensors[0])
    if any(graph.shape(t)[2:] != (height, width) for t in tensors):
        sizes = " and ".join("x".join(map(str, graph.shape(t)[2:])) for t in tensors)
        raise ConversionError(f"cannot join feature maps of {sizes} cells: height and width must be multiples of 32")
    return graph.add("Concat", tensors, (batch, sum(graph.shape(t)[1] for t in tensors), height, width), axis=1)


def add(graph, left, right, weight=1.0):
    """left + weight * right."""
    if weight != 1.0:
        right = graph.add("Mul", [right, graph.constant(np.float32(weight))], graph.shape(right))
    return graph.add("Add", [left, right], graph.shape(left))


def max_pool(graph, tensor, layer):
    kernel, stride, padding = (_pair(layer.require(name)) for name in ("kernel_size", "stride", "padding"))
    batch, channels, height, width = graph.shape(tensor)
    rows, cols = ((n + 2 * p - k) // s + 1 for n, p, k, s in zip((height, width), padding, kernel, stride))
    return graph.add(
        "MaxPool", [tensor], (batch, channels, rows, cols), kernel_shape=kernel, strides=stride, pads=padding + padding
    )


def stem(graph, tensor, layer):
    """conv_bn_relu_maxpool, the first layer of YOLOv5-Lite."""
    return max_pool(graph, sequential(graph, tensor, layer.require("conv")), layer.require("maxpool"))


def focus(graph, tensor, layer):
    """Focus, the first layer of YOLOv5 before 6.0: every second pixel, four times, as channels."""
    batch, channels, height, width = graph.shape(tensor)
    parts = []
    for row, col in ((0, 0), (1, 0), (0, 1), (1, 1)):
        bounds = [np.array(v, np.int64) for v in ((row, col), (height, width), (2, 3), (2, 2))]
        shape = (batch, channels, (height + 1 - row) // 2, (width + 1 - col) // 2)
        parts.append(graph.add("Slice", [tensor] + [graph.constant(b) for b in bounds], shape))
    return forward(graph, concat(graph, parts), layer.require("conv"))


def shuffle_block(graph, tensor, layer):
    """ShuffleNetV2 block; the channel shuffle has four dimensions, which OpenCV permutes twice as fast as five."""
    if layer.require("stride") == 1:
        batch, channels, height, width = graph.shape(tensor)
        half = channels // 2
        kept, changed = graph.add_multiple(
            "Split", [tensor], [(batch, half, height, width)] * 2, axis=1, split=[half, half]
        )
        tensor = concat(graph, [kept, sequential(graph, changed, layer.require("branch2"))])
    else:
        branches = [sequential(graph, tensor, layer.require(name)) for name in ("branch1", "branch2")]
        tensor = concat(graph, branches)
    batch, channels, height, width = graph.shape(tensor)
    half, cells = channels // 2, height * width
    tensor = reshape_images(graph, tensor, (batch, 2, half, cells))
    tensor = graph.add("Transpose", [tensor], (batch, half, 2, cells), perm=[0, 2, 1, 3])
    return reshape_images(graph, tensor, (batch, channels, height, width))


def reshape_images(graph, tensor, shape):
    """Reshapes each image of the batch; the number of images stays free (0 copies the dimension)."""
    return graph.add("Reshape", [tensor, graph.constant(np.array((0,) + shape[1:], np.int64))], shape)


def depthwise_block(graph, tensor, layer):
    """DWConvblock of YOLOv5-Lite e: depthwise, then pointwise convolution, each with ReLU."""
    for number in ("1", "2"):
        tensor = convolution(graph, tensor, layer.require("conv" + number), layer.get("bn" + number))
        tensor = graph.add("Relu", [tensor], graph.shape(tensor))
    return tensor


def bottleneck(graph, tensor, layer):
    changed = forward(graph, forward(graph, tensor, layer.require("cv1")), layer.require("cv2"))
    return add(graph, tensor, changed) if layer.get("add") else changed


def c3(graph, tensor, layer):
    deep = forward(graph, forward(graph, tensor, layer.require("cv1")), layer.require("m"))
    joined = concat(graph, [deep, forward(graph, tensor, layer.require("cv2"))])
    return forward(graph, joined, layer.require("cv3"))


def spp(graph, tensor, layer):
    tensor = forward(graph, tensor, layer.require("cv1"))
    pooled = [max_pool(graph, tensor, pool) for pool in layer.require("m").children()]
    return forward(graph, concat(graph, [tensor] + pooled), layer.require("cv2"))


def sppf(graph, tensor, layer):
    tensors = [forward(graph, tensor, layer.require("cv1"))]
    for _ in range(3):
        tensors.append(max_pool(graph, tensors[-1], layer.require("m")))
    return forward(graph, concat(graph, tensors), layer.require("cv2"))


def upsample(graph, tensor, layer):
    """Nearest-neighbour enlargement by a whole factor."""
    factor = int(layer.require("scale_factor"))
    batch, channels, height, width = graph.shape(tensor)
    no_region = graph.constant(np.zeros(0, np.float32))
    scales = graph.constant(np.array([1, 1, factor, factor], np.float32))
    return graph.add(
        "Resize", [tensor, no_region, scales], (batch, channels, height * factor, width * factor),
        mode="nearest", coordinate_transformation_mode="asymmetric", nearest_mode="floor",
    )  # fmt: skip


def _pair(value):
    return [value, value] if isinstance(value, int) else [int(v) for v in value]


_LAYERS = {
    "Sequential": sequential,
    "Conv2d": convolution,
    "Conv": conv_block,
    "DWConv": conv_block,
    "conv_bn_relu_maxpool": stem,
    "Focus": focus,
    "MaxPool2d": max_pool,
    "Shuffle_Block": shuffle_block,
    "DWConvblock": depthwise_block,
    "Bottleneck": bottleneck,
    "C3": c3,
    "SPP": spp,
    "SPPF": sppf,
    "Upsample": upsample,
    "SiLU": activation,
    "ReLU": activation,
    "LeakyReLU": activation,
    "Hardswish": activation,
    "Sigmoid": activation,
    "Identity": identity,
    "Dropout": identity,
}
