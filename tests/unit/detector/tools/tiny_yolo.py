# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""A small network with every layer type of the family, random weights, and what it must compute, in plain numpy."""

import numpy as np
from fake_torch import Tensor, layer

CLASSES = ["person", "box"]
ANCHORS_PX = np.array([[[10, 13], [16, 30], [33, 23]], [[30, 61], [62, 45], [59, 119]], [[116, 90], [156, 198], [373, 326]]])
STRIDES = np.array([8.0, 16.0, 32.0], np.float32)


class TinyYolo:
    """Builds the layers; remembers the random state so that the network is the same in every run."""

    def __init__(self, seed=1):
        self.random = np.random.RandomState(seed)

    def conv2d(self, inputs, outputs, kernel=1, stride=1, groups=1, bias=False):
        parameters = {"weight": self.random.randn(outputs, inputs // groups, kernel, kernel).astype(np.float32) * 0.3}
        if bias:
            parameters["bias"] = self.random.randn(outputs).astype(np.float32)
        pad = (kernel // 2, kernel // 2)
        return layer(
            "Conv2d", None, parameters, module="torch.nn.modules.conv", kernel_size=(kernel, kernel),
            stride=(stride, stride), padding=pad, dilation=(1, 1), groups=groups,
        )  # fmt: skip

    def batch_norm(self, channels):
        values = self.random.rand(4, channels).astype(np.float32) + 0.5
        return layer(
            "BatchNorm2d", None, {"weight": values[0], "bias": values[1] - 1},
            {"running_mean": values[2] - 1, "running_var": values[3]}, "torch.nn.modules.batchnorm", eps=1e-3,
        )  # fmt: skip

    def activation(self, name="SiLU", **attributes):
        return layer(name, module="torch.nn.modules.activation", **attributes)

    def conv(self, inputs, outputs, kernel=1, stride=1, act="SiLU"):
        parts = {"conv": self.conv2d(inputs, outputs, kernel, stride), "bn": self.batch_norm(outputs)}
        return layer("Conv", {**parts, "act": self.activation(act)})

    def sequential(self, *parts):
        return layer("Sequential", {str(i): p for i, p in enumerate(parts)}, module="torch.nn.modules.container")

    def max_pool(self, kernel, stride, padding):
        return layer("MaxPool2d", module="torch.nn.modules.pooling", kernel_size=kernel, stride=stride, padding=padding)

    def shuffle(self, inputs, outputs, stride):
        half, into = outputs // 2, inputs // 2 if stride == 1 else inputs
        deep = self.sequential(
            self.conv2d(into, half), self.batch_norm(half), self.activation("ReLU"),
            self.conv2d(half, half, 3, stride, half), self.batch_norm(half),
            self.conv2d(half, half), self.batch_norm(half), self.activation("ReLU"),
        )  # fmt: skip
        short = [self.conv2d(inputs, inputs, 3, 2, inputs), self.batch_norm(inputs), self.conv2d(inputs, half)]
        branch1 = self.sequential(*short, self.batch_norm(half)) if stride == 2 else self.sequential()
        return layer("Shuffle_Block", {"branch1": branch1, "branch2": deep}, stride=stride)

    def c3(self, channels):
        half = channels // 2
        bottleneck = layer("Bottleneck", {"cv1": self.conv(half, half), "cv2": self.conv(half, half, 3)}, add=True)
        parts = {"cv1": self.conv(channels, half), "cv2": self.conv(channels, half), "cv3": self.conv(channels, channels)}
        return layer("C3", {**parts, "m": self.sequential(bottleneck)})

    def depthwise(self, inputs, outputs):
        parts = {"conv1": self.conv2d(inputs, inputs, 3, 1, inputs), "bn1": self.batch_norm(inputs)}
        return layer("DWConvblock", {**parts, "conv2": self.conv2d(inputs, outputs), "bn2": self.batch_norm(outputs)})

    def pyramid_pooling(self, name, channels):
        pools = [self.max_pool(k, 1, k // 2) for k in (3, 5, 7)]
        m = self.sequential(*pools) if name == "SPP" else self.max_pool(5, 1, 2)
        return layer(name, {"cv1": self.conv(channels, 4), "cv2": self.conv(16, channels), "m": m})

    def detect(self, channels):
        heads = [self.conv2d(c, 3 * (5 + len(CLASSES)), bias=True) for c in channels]
        anchors = (ANCHORS_PX / STRIDES[:, None, None]).astype(np.float32)
        return layer(
            "Detect", {"m": self.sequential(*heads)}, buffers={"anchors": anchors}, module="models.yolo",
            nc=len(CLASSES), stride=Tensor(STRIDES),
        )  # fmt: skip

    def layers(self):
        """(layer, from): -1 is the layer before."""
        stem = layer(
            "conv_bn_relu_maxpool",
            {"conv": self.sequential(self.conv2d(8, 8, 3), self.batch_norm(8), self.activation("ReLU")),
             "maxpool": self.max_pool(3, 2, 1)},
        )  # fmt: skip
        upsample = layer("Upsample", module="torch.nn.modules.upsampling", scale_factor=2.0, mode="nearest")
        return [
            (layer("Focus", {"conv": self.conv(12, 8, act="Hardswish")}), -1),  # 0: /2
            (stem, -1),  # 1: /4
            (self.shuffle(8, 8, 2), -1),  # 2: /8
            (self.shuffle(8, 8, 1), -1),  # 3
            (self.conv(8, 8, 3, 2), -1),  # 4: /16
            (self.c3(8), -1),  # 5
            (self.conv(8, 8, 3, 2, "ReLU"), -1),  # 6: /32
            (self.pyramid_pooling("SPP", 8), -1),  # 7
            (self.pyramid_pooling("SPPF", 8), -1),  # 8
            (upsample, -1),  # 9: /16
            (layer("Concat"), [-1, 5]),  # 10: 16 channels
            (self.depthwise(16, 8), -1),  # 11
            (layer("ADD", a=0.5), [-1, 4]),  # 12
            (self.detect([8, 8, 8]), [3, 12, 8]),
        ]

    def checkpoint(self, **extra):
        """What torch.save() of YOLOv5's train.py holds."""
        parts = self.layers()
        for part, came_from in parts:
            part.f = came_from
        self.parts = parts
        model = layer(
            "Model", {"model": self.sequential(*[p for p, _ in parts])}, module="models.yolo", names=list(CLASSES)
        )
        return {"epoch": -1, "model": model, "ema": None, "optimizer": None, **extra}


def reference(parts, image):
    """The raw head outputs for `image` (1x3xHxW), computed step by step."""
    x, outputs = image.astype(np.float64), []
    for part, came_from in parts:
        sources = came_from if isinstance(came_from, list) else [came_from]
        inputs = [x if s == -1 else outputs[s] for s in sources]
        name = type(part).__name__
        if name == "Detect":
            return [conv2d(t, c) for t, c in zip(inputs, part._modules["m"]._modules.values())]
        if name == "Concat":
            x = np.concatenate(inputs, 1)
        elif name == "ADD":
            x = inputs[0] + part.a * inputs[1]
        else:
            x = apply(inputs[0], part)
        outputs.append(x)
    raise AssertionError("no Detect layer")


def apply(x, part):
    """One layer, written as its PyTorch forward() reads."""
    name, parts = type(part).__name__, part._modules
    if name == "Conv2d":
        return conv2d(x, part)
    if name == "BatchNorm2d":
        weight, bias = (part._parameters[k].values[None, :, None, None] for k in ("weight", "bias"))
        mean, var = (part._buffers[k].values[None, :, None, None] for k in ("running_mean", "running_var"))
        return (x - mean) / np.sqrt(var + part.eps) * weight + bias
    if name == "SiLU":
        return x / (1 + np.exp(-x))
    if name == "ReLU":
        return np.maximum(x, 0)
    if name == "Hardswish":
        return x * np.clip(x + 3, 0, 6) / 6
    if name in ("Conv", "Sequential"):
        for child in parts.values():
            x = apply(x, child)
        return x
    if name == "conv_bn_relu_maxpool":
        return pool(apply(x, parts["conv"]), parts["maxpool"])
    if name == "Focus":
        corners = [x[..., r::2, c::2] for r, c in ((0, 0), (1, 0), (0, 1), (1, 1))]
        return apply(np.concatenate(corners, 1), parts["conv"])
    if name == "Shuffle_Block":
        return shuffle_block(x, part)
    if name == "C3":
        y = apply(apply(x, parts["cv1"]), parts["m"])
        return apply(np.concatenate([y, apply(x, parts["cv2"])], 1), parts["cv3"])
    if name == "Bottleneck":
        return x + apply(apply(x, parts["cv1"]), parts["cv2"])
    if name == "DWConvblock":
        for number in "12":
            x = np.maximum(apply(apply(x, parts["conv" + number]), parts["bn" + number]), 0)
        return x
    if name == "SPP":
        x = apply(x, parts["cv1"])
        pooled = [pool(x, p) for p in parts["m"]._modules.values()]
        return apply(np.concatenate([x] + pooled, 1), parts["cv2"])
    if name == "SPPF":
        stages = [apply(x, parts["cv1"])]
        for _ in range(3):
            stages.append(pool(stages[-1], parts["m"]))
        return apply(np.concatenate(stages, 1), parts["cv2"])
    assert name == "Upsample", name
    return x.repeat(2, 2).repeat(2, 3)


def shuffle_block(x, part):
    if part.stride == 1:
        half = x.shape[1] // 2
        x = np.concatenate([x[:, :half], apply(x[:, half:], part._modules["branch2"])], 1)
    else:
        x = np.concatenate([apply(x, part._modules[b]) for b in ("branch1", "branch2")], 1)
    n, c, h, w = x.shape
    return x.reshape(n, 2, c // 2, h, w).transpose(0, 2, 1, 3, 4).reshape(n, c, h, w)


def windows(x, kernel, stride, padding, fill):
    padded = np.pad(x, ((0, 0), (0, 0), (padding, padding), (padding, padding)), constant_values=fill)
    view = np.lib.stride_tricks.sliding_window_view(padded, (kernel, kernel), (2, 3))
    return view[:, :, ::stride, ::stride]


def conv2d(x, part):
    weight, groups = part._parameters["weight"].values.astype(np.float64), part.groups
    views = windows(x, part.kernel_size[0], part.stride[0], part.padding[0], 0.0)
    per_in, per_out = x.shape[1] // groups, weight.shape[0] // groups
    maps = []
    for g in range(groups):
        inputs = views[:, g * per_in : (g + 1) * per_in]
        maps.append(np.einsum("nchwij,ocij->nohw", inputs, weight[g * per_out : (g + 1) * per_out]))
    bias = part._parameters.get("bias")
    return np.concatenate(maps, 1) + (0 if bias is None else bias.values[None, :, None, None])


def pool(x, part):
    return windows(x, part.kernel_size, part.stride, part.padding, -np.inf).max((4, 5))
