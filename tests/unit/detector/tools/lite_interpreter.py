# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Computes a TensorFlow Lite graph in numpy by the definitions of its operators, in its own order N, H, W, C."""

import struct

import numpy as np


def interpret(model, image):
    """The values of every tensor that is computed, by number. `image` is 1 x H x W x 3."""
    values = {i: t.values() for i, t in enumerate(model.tensors) if t.constant}
    values[model.inputs[0]] = image.astype(np.float32)
    computed = {}
    for operator in model.operators:
        inputs = [values[i] for i in operator.inputs]
        result = globals()["compute_" + operator.name.strip("'").lower()](operator, *inputs)
        values[operator.outputs[0]] = computed[operator.outputs[0]] = result
    return computed


def activated(x, kind):
    return np.maximum(x, 0) if kind == 1 else x


def compute_dequantize(operator, x):
    return x


def compute_relu(operator, x):
    return np.maximum(x, 0)


def compute_logistic(operator, x):
    return np.exp(-np.logaddexp(0, -x))


def compute_hard_swish(operator, x):
    return x * np.clip(x + 3, 0, 6) / 6


def compute_add(operator, a, b):
    return activated(a + b, operator.option(0, "<b"))


def compute_mul(operator, a, b):
    return activated(a * b, operator.option(0, "<b"))


def compute_average_pool_2d(operator, x):
    return x.mean(axis=(1, 2), keepdims=True)


def padded(operator, x, kernel, strides):
    """The image with zeros around it (padding SAME is 0), and the size of the output."""
    if operator.option(0, "<b") != 0:
        return x, [(x.shape[1 + i] - kernel[i]) // strides[i] + 1 for i in (0, 1)]
    sizes = [-(-x.shape[1 + i] // strides[i]) for i in (0, 1)]
    total = [max(0, (sizes[i] - 1) * strides[i] + kernel[i] - x.shape[1 + i]) for i in (0, 1)]
    return np.pad(x, [(0, 0)] + [(t // 2, t - t // 2) for t in total] + [(0, 0)]), sizes


def windows(operator, x, kernel):
    """Yields row and column of the kernel and the part of the image that they meet."""
    strides = operator.option(2, "<i"), operator.option(1, "<i")
    x, sizes = padded(operator, x, kernel, strides)
    for row in range(kernel[0]):
        for column in range(kernel[1]):
            rows = slice(row, row + (sizes[0] - 1) * strides[0] + 1, strides[0])
            columns = slice(column, column + (sizes[1] - 1) * strides[1] + 1, strides[1])
            yield row, column, x[:, rows, columns]


def compute_conv_2d(operator, x, weights, bias):
    total = sum(part @ weights[:, r, c].T for r, c, part in windows(operator, x, weights.shape[1:3]))
    return activated(total + bias, operator.option(3, "<b"))


def compute_depthwise_conv_2d(operator, x, weights, bias):
    total = sum(part * weights[0, r, c] for r, c, part in windows(operator, x, weights.shape[1:3]))
    return activated(total + bias, operator.option(4, "<b"))


def blend(x, axis, size):
    """Linear between the centres of pixels along one axis."""
    place = np.clip((np.arange(size) + 0.5) * x.shape[axis] / size - 0.5, 0, x.shape[axis] - 1)
    low = np.floor(place).astype(int)
    high = np.minimum(low + 1, x.shape[axis] - 1)
    share = (place - low).reshape([-1 if i == axis else 1 for i in range(4)])
    return np.take(x, low, axis) * (1 - share) + np.take(x, high, axis) * share


def compute_resize_bilinear(operator, x, sizes):
    return blend(blend(x, 1, sizes[0]), 2, sizes[1])


def compute_convolution2dtransposebias(operator, x, weights, bias):
    _, columns, rows = struct.unpack("<iii", operator.custom_options)
    result = np.zeros((1, x.shape[1] * rows, x.shape[2] * columns, weights.shape[0]), np.float32)
    for r in range(rows):
        for c in range(columns):
            result[:, r::rows, c::columns] = x @ weights[:, r, c].T
    return result + bias
