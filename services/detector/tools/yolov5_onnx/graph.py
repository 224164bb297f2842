# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""An ONNX graph under construction that knows the shape of every tensor."""

import numpy as np
from onnx import TensorProto, checker, helper, numpy_helper, shape_inference

from .errors import ConversionError

OPSET = 11  # what OpenCV 4.6 reads best
IR_VERSION = 6
BATCH = "batch"  # the free dimension


class Graph:
    """Collects nodes and constants. Tensors are handled by name; shape(name) gives N, C, H, W."""

    def __init__(self, input_name, input_shape):
        self.input_name = input_name
        self._shapes = {input_name: tuple(input_shape)}
        self._nodes = []
        self._constants = []
        self._count = 0

    def shape(self, tensor):
        return self._shapes[tensor]

    def constant(self, values):
        name = self._new_name("const")
        self._constants.append(numpy_helper.from_array(np.ascontiguousarray(values), name))
        return name

    def add(self, operator, inputs, shape, **attributes):
        """Adds a node with one output of the given shape; returns the output's name."""
        return self.add_multiple(operator, inputs, [shape], **attributes)[0]

    def add_multiple(self, operator, inputs, shapes, **attributes):
        """Adds a node with one output per shape; returns their names."""
        if any(length <= 0 for shape in shapes for length in shape):
            raise ConversionError(f"the input is too small: {operator} would give a tensor of shape {shapes}")
        outputs = [self._new_name(operator.lower()) for _ in shapes]
        self._nodes.append(helper.make_node(operator, list(inputs), outputs, name=f"{outputs[0]}_node", **attributes))
        for output, shape in zip(outputs, shapes):
            self._shapes[output] = tuple(shape)
        return outputs

    def parameter_count(self):
        """Number of trained values."""
        return sum(int(np.prod(c.dims)) for c in self._constants if c.data_type == TensorProto.FLOAT)

    def to_model(self, outputs, metadata, name="yolov5"):
        """The finished, checked ONNX model. `outputs` maps tensor -> name in the file, `name` is the graph's."""
        for node in self._nodes:
            for i, tensor in enumerate(node.output):
                node.output[i] = outputs.get(tensor, tensor)
        graph = helper.make_graph(
            self._nodes,
            name,
            [self._image_tensor(self.input_name, self.input_name)],
            [self._image_tensor(tensor, output) for tensor, output in outputs.items()],
            self._constants,
        )
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], producer_name="rtd-slam")
        model.ir_version = IR_VERSION
        helper.set_model_props(model, metadata)
        try:
            checker.check_model(model, full_check=True)
        except (checker.ValidationError, shape_inference.InferenceError) as error:
            raise ConversionError(f"the layers do not fit together: {error}") from error
        return model

    def _image_tensor(self, tensor, name):
        """An input or output of the graph: any number of images."""
        return helper.make_tensor_value_info(name, TensorProto.FLOAT, (BATCH,) + self.shape(tensor)[1:])

    def _new_name(self, prefix):
        self._count += 1
        return f"{prefix}_{self._count}"
