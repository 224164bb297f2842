# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""From a loaded checkpoint to an ONNX model with one raw output per detection head."""

import numpy as np

from . import layers
from .checkpoint import Module
from .errors import ConversionError
from .graph import Graph

STRIDE_MULTIPLE = 32


def convert(checkpoint, height_px, width_px):
    """An ONNX model with input `images` (1x3xHxW, RGB / 255) and outputs `p3`, `p4`, ... : the logits of the heads.

    Metadata: `rtd.class_names`, one a line, and `rtd.heads`, one line "stride: w,h w,h w,h" (anchors, px) per output.
    """
    if height_px % STRIDE_MULTIPLE or width_px % STRIDE_MULTIPLE or min(height_px, width_px) <= 0:
        raise ConversionError(f"size {height_px}x{width_px}: height and width must be multiples of {STRIDE_MULTIPLE}")
    model = find_model(checkpoint)
    graph = Graph("images", (1, 3, height_px, width_px))
    heads, detect = walk(graph, model)
    names = {tensor: f"p{number}" for number, tensor in enumerate(heads, start=3)}
    return graph.to_model(names, describe(model, detect)), graph.parameter_count()


def find_model(checkpoint):
    """The averaged weights ("ema") when there are any, as YOLOv5 itself does, else the last ones."""
    if isinstance(checkpoint, dict):
        checkpoint = checkpoint.get("ema") or checkpoint.get("model")
    if not isinstance(checkpoint, Module) or not isinstance(checkpoint.get("model"), Module):
        raise ConversionError("not a YOLOv5 checkpoint: it contains no model (a state dict alone is not enough)")
    return checkpoint


def walk(graph, model):
    """Adds all layers. `f` of a layer lists its inputs; -1 is the previous layer. Returns heads, Detect layer."""
    outputs = []
    for number, layer in enumerate(model.require("model").children()):
        try:
            inputs = [_source(graph, outputs, source) for source in _as_list(layer.require("f"))]
            if layer.class_name == "Detect":
                return detection_heads(graph, inputs, layer), layer
            outputs.append(add_layer(graph, inputs, layer))
        except ConversionError as error:
            raise ConversionError(f"layer {number}: {error}") from error
        except (TypeError, ValueError, IndexError, AttributeError) as error:
            raise ConversionError(f"layer {number} is not the known {layer.class_name}: {error}") from error
    raise ConversionError("the model has no Detect layer: only detection networks of the YOLOv5 family are converted")


def add_layer(graph, inputs, layer):
    """One layer of the model; the first two types are the only ones with several inputs."""
    if layer.class_name == "Concat":
        return layers.concat(graph, inputs)
    if layer.class_name == "ADD":  # YOLOv5-Lite e: x + a * y
        return layers.add(graph, inputs[0], inputs[1], float(layer.get("a", 1.0)))
    return layers.forward(graph, inputs[0], layer)


def _source(graph, outputs, index):
    if index == -1:
        return outputs[-1] if outputs else graph.input_name
    return outputs[index]


def _as_list(value):
    return value if isinstance(value, list) else [value]


def detection_heads(graph, inputs, detect):
    """The last convolution of each head; the detector decodes its output only where there is an object."""
    convolutions = detect.require("m").children()
    if len(convolutions) != len(inputs):
        raise ConversionError(f"Detect has {len(convolutions)} heads for {len(inputs)} inputs")
    return [layers.convolution(graph, tensor, conv) for tensor, conv in zip(inputs, convolutions)]


def describe(model, detect):
    """What a reader of the outputs must know, as ONNX metadata."""
    names = model.get("names") or detect.get("names") or []
    if isinstance(names, dict):
        names = [names[key] for key in sorted(names)]
    strides = np.asarray(detect.require("stride"), np.float64).reshape(-1)
    heads = []
    for stride, anchors in zip(strides, anchors_px(detect, strides)):
        heads.append(f"{stride:g}: " + " ".join(f"{width:g},{height:g}" for width, height in anchors))
    return {"rtd.class_names": "\n".join(str(name) for name in names), "rtd.heads": "\n".join(heads)}


def anchors_px(detect, strides):
    """Anchor sizes per head in pixels. `anchor_grid` has them; without it, `anchors` has them divided by the stride."""
    grid = detect.get("anchor_grid")
    if isinstance(grid, np.ndarray) and grid.size:
        return np.asarray(grid, np.float64).reshape(len(strides), -1, 2)
    anchors = np.asarray(detect.require("anchors"), np.float64).reshape(len(strides), -1, 2)
    return anchors * strides[:, None, None]
