# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Frees the batch dimension of an ONNX file whose Reshapes name it."""

import onnx
from onnx import numpy_helper

from .errors import ConversionError
from .graph import BATCH


def free_batch(model):
    """Changes the model in place: every Reshape copies the batch dimension, inputs and outputs leave it open. Returns
    how many Reshapes were changed. Raises ConversionError for a Reshape that mixes images with each other."""
    shapes = _reshape_shapes(model.graph)
    changed = sum(_free_shape(tensor) for tensor in shapes.values())
    weights = {tensor.name for tensor in model.graph.initializer}  # old files list them among the inputs
    for value in list(model.graph.input) + list(model.graph.output):
        if value.name not in weights:
            _free_dimension(value)
    del model.graph.value_info[:]  # shapes between the layers, with the batch of before
    try:
        onnx.checker.check_model(model, full_check=True)
    except onnx.shape_inference.InferenceError as error:
        raise ConversionError(f"the shapes do not fit each other: {error}") from error
    return changed


def _free_dimension(value):
    dimensions = value.type.tensor_type.shape.dim
    if not dimensions:  # a scalar, or a shape that is not given
        return
    if dimensions[0].HasField("dim_value") and dimensions[0].dim_value != 1:
        raise ConversionError(f"'{value.name}' has {dimensions[0].dim_value} images: only batch 1 is freed")
    dimensions[0].dim_param = BATCH


def _reshape_shapes(graph):
    """The constants that are shapes of Reshapes, by name: initializers or outputs of Constant nodes."""
    constants = {tensor.name: tensor for tensor in graph.initializer}
    for node in graph.node:
        if node.op_type == "Constant" and node.attribute and node.attribute[0].name == "value":
            constants[node.output[0]] = node.attribute[0].t
    shapes = {}
    for node in graph.node:
        if node.op_type != "Reshape":
            continue
        if node.input[1] not in constants:
            raise ConversionError(f"Reshape '{node.name}' computes its shape: export the network with constant shapes")
        shapes[node.input[1]] = constants[node.input[1]]
    return shapes


def _free_shape(tensor):
    shape = numpy_helper.to_array(tensor).copy()
    if shape.size < 2 or shape[0] not in (0, 1):
        raise ConversionError(f"a Reshape to {shape.tolist()} does not keep images apart: only batch 1 is freed")
    if shape[0] == 0:
        return 0
    shape[0] = 0
    tensor.CopyFrom(numpy_helper.from_array(shape, tensor.name))
    return 1
