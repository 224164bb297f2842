# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""nanodet_to_onnx.py on a small graph model, whole and damaged."""

import base64
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[4] / "services/detector/tools"
sys.path.insert(0, str(TOOLS))

import cv2  # noqa: E402
import numpy as np  # noqa: E402
from tfjs_onnx.nanodet import convert  # noqa: E402
from tfjs_onnx.reader import load_graph_model  # noqa: E402
from yolov5_onnx.errors import ConversionError  # noqa: E402

CLASSES, BINS, SIZE = 2, 3, 64
PLANES = CLASSES + 4 * BINS


class SmallGraph:
    """Per stride one convolution over whole cells with a leaky rectifier behind it."""

    def __init__(self):
        self.nodes, self.entries, self.data = [], [], b""
        self.random = np.random.default_rng(3)
        self.node("Placeholder", "image", [], shape={"shape": {"dim": [{"size": str(n)} for n in (1, 3, SIZE, SIZE)]}})
        self.node("Transpose", "last", ["image", self.integers("to_last", [0, 2, 3, 1])])
        self.kernels, self.biases = {}, {}
        for stride in (8, 16, 32):
            self.head(stride)

    def weight(self, name, shape, dtype, values, **more):
        self.entries.append({"name": name, "shape": list(shape), "dtype": dtype, **more})
        self.data += values.tobytes()
        return name

    def integers(self, name, values):
        return self.weight(name, np.shape(values), "int32", np.asarray(values, "<i4"))

    def halves(self, name, shape):
        values = self.random.normal(size=shape).astype("<f2")
        self.weight(name, shape, "float32", values, quantization={"dtype": "float16", "original_dtype": "float32"})
        return values.astype(np.float32)

    def node(self, operator, name, inputs, **attributes):
        self.nodes.append({"op": operator, "name": name, "input": inputs, "attr": attributes})

    def head(self, stride):
        of = lambda text: f"{text}_{stride}"  # noqa: E731
        self.kernels[stride] = self.halves(of("kernel"), (stride, stride, 3, PLANES))
        self.biases[stride] = self.halves(of("bias"), (PLANES,))
        ones = {"list": {"i": ["1", "1", "1", "1"]}}
        steps = {"list": {"i": ["1", str(stride), str(stride), "1"]}}
        valid = {"s": base64.b64encode(b"VALID").decode()}
        self.node("Conv2D", of("conv"), ["last:0", of("kernel")], strides=steps, dilations=ones, padding=valid)
        self.node("Add", of("add"), [of("conv"), of("bias")])
        self.node("Transpose", of("first"), [of("add"), self.integers(of("to_first"), [0, 3, 1, 2])])
        self.node("LeakyRelu", of("relu"), [of("first")], alpha={"f": 0.1})
        sizes, axis = self.integers(of("sizes"), [CLASSES, 4 * BINS]), self.integers(of("axis"), 1)
        self.node("SplitV", of("split"), [of("relu"), sizes, axis])
        self.node("Sigmoid", of("scores"), [of("split")])

    def json(self):
        return {
            "format": "graph-model",
            "modelTopology": {"node": self.nodes},
            "weightsManifest": [{"paths": ["weights.bin"], "weights": self.entries}],
        }

    def expected(self, image, stride):
        """The head of a stride by its definition."""
        cells = SIZE // stride
        patches = image[0].reshape(3, cells, stride, cells, stride).transpose(1, 3, 2, 4, 0)
        planes = np.tensordot(patches, self.kernels[stride], 3) + self.biases[stride]
        return np.where(planes > 0, planes, 0.1 * planes).transpose(2, 0, 1)


class NanodetConverter(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.graph = SmallGraph()

    def convert(self, text=None, data=None):
        """The model of the small graph, or of other contents of its files."""
        (self.folder / "graph.json").write_bytes(json.dumps(self.graph.json()).encode() if text is None else text)
        (self.folder / "weights.bin").write_bytes(self.graph.data if data is None else data)
        return convert(load_graph_model(self.folder / "graph.json", self.folder / "weights.bin"))

    def assert_refused(self, pattern, **files):
        with self.assertRaisesRegex(ConversionError, pattern):
            self.convert(**files)

    def test_computes_what_the_graph_says(self):
        model, parameters = self.convert()
        self.assertEqual(parameters, sum(k.size for k in self.graph.kernels.values()) + 3 * PLANES)
        network = cv2.dnn.readNetFromONNX(np.frombuffer(model.SerializeToString(), np.uint8))
        image = np.random.default_rng(5).normal(size=(1, 3, SIZE, SIZE)).astype(np.float32)
        network.setInput(image)
        for stride in (8, 16, 32):
            found = network.forward(f"stride_{stride}")
            self.assertEqual(found.shape, (1, PLANES, SIZE // stride, SIZE // stride))
            self.assertLess(np.abs(found[0] - self.graph.expected(image, stride)).max(), 1e-3)

    def test_describes_the_network(self):
        model, _ = self.convert()
        metadata = {entry.key: entry.value for entry in model.metadata_props}
        self.assertEqual(metadata, {"rtd.decoder": "nanodet", "rtd.class_count": str(CLASSES)})
        self.assertEqual([output.name for output in model.graph.output], ["stride_8", "stride_16", "stride_32"])

    def test_refuses_weights_of_another_length(self):
        for size in range(0, len(self.graph.data), 997):
            self.assert_refused("truncated", data=self.graph.data[:size])
        self.assert_refused("bytes, but", data=self.graph.data + b"\0")

    def test_refuses_a_graph_cut_off_anywhere(self):
        text = json.dumps(self.graph.json()).encode()
        for size in range(0, len(text) - 1, 97):
            self.assert_refused("is not JSON, or truncated", text=text[:size])

    def test_refuses_shapes_that_cannot_be(self):
        for shape in ([-1, 3], [1 << 40, 1 << 40], [2.5], ["4"], [True], {"a": 1}, None, [[4]]):
            self.graph.entries[1]["shape"] = shape
            self.assert_refused("shape")

    def test_refuses_weights_that_do_not_fit_their_layer(self):
        kernel = next(entry for entry in self.graph.entries if entry["name"] == "kernel_8")
        kernel["shape"] = [8, 8, PLANES, 3]
        self.assert_refused("biases for 3 channels|channels")
        kernel["shape"] = [8 * 8 * 3 * PLANES]
        self.assert_refused("dimensions")

    def test_refuses_other_formats_of_numbers(self):
        for changed in ({"dtype": "uint8"}, {"quantization": {"dtype": "uint8", "min": 0, "scale": 1}}, {"dtype": 5}):
            self.graph = SmallGraph()
            self.graph.entries[2].update(changed)
            self.assert_refused("stored in a way|no text 'dtype'|truncated")

    def test_refuses_numbers_that_are_none(self):
        for number in (np.nan, np.inf):
            data = bytearray(self.graph.data)
            data[16:18] = np.asarray(number, "<f2").tobytes()  # the first of kernel_8
            self.assert_refused("infinite or none", data=bytes(data))

    def test_refuses_layers_of_other_networks(self):
        self.graph.nodes[2]["op"] = "MatMul"
        self.assert_refused("the operator MatMul is not one of NanoDet's")
        self.graph = SmallGraph()
        self.graph.nodes.reverse()
        self.assert_refused("is not computed before it|which is not there")
        self.graph = SmallGraph()
        self.graph.nodes = [node for node in self.graph.nodes if node["name"] != "split_16"]
        self.assert_refused("has 2 heads")

    def test_gives_no_other_error_for_any_damage(self):
        text = json.dumps(self.graph.json()).encode()
        generator = random.Random(7)
        for _ in range(300):
            damaged = bytearray(text)
            for _ in range(generator.randint(1, 4)):
                damaged[generator.randrange(len(damaged))] = generator.choice(b'0123456789"[]{},:-.eaNtf')
            try:
                self.convert(text=bytes(damaged))
            except ConversionError:
                pass

    def test_names_a_missing_file_and_leaves_nothing_behind(self):
        result = subprocess.run(
            [TOOLS / "nanodet_to_onnx.py", "/nowhere.json", "/nowhere.bin", self.folder / "out.onnx"],
            capture_output=True, text=True, check=False
        )  # fmt: skip
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, "^nanodet_to_onnx: /nowhere.json: No such file")
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
