# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""selfie_to_onnx.py on a small network and on the real one, whole and damaged."""

import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[4] / "services/detector/tools"
sys.path.insert(0, str(TOOLS))

import cv2  # noqa: E402
import numpy as np  # noqa: E402
from lite_interpreter import interpret  # noqa: E402
from tflite_onnx.person_mask import convert  # noqa: E402
from tflite_onnx.reader import load_model, read_model  # noqa: E402
from tiny_lite import SIDE, TinyLite  # noqa: E402
from yolov5_onnx.errors import ConversionError  # noqa: E402


def computed_by_opencv(onnx_model, image):
    """The output of the ONNX model for an image 1 x H x W x 3."""
    network = cv2.dnn.readNetFromONNX(np.frombuffer(onnx_model.SerializeToString(), np.uint8))
    network.setInput(np.ascontiguousarray(image.transpose(0, 3, 1, 2)))
    return network.forward()[0, 0]


class PersonMaskConverter(unittest.TestCase):
    def assert_same_outputs(self, lite, side, tolerance):
        onnx_model, _ = convert(lite)
        for seed in range(3):
            image = np.random.default_rng(seed).random((1, side, side, 3)).astype(np.float32)
            image = cv2.GaussianBlur(image[0], (0, 0), 1 + seed)[np.newaxis]
            expected = interpret(lite, image)[lite.outputs[0]][0, :, :, 0]
            found = computed_by_opencv(onnx_model, image)
            self.assertEqual(found.shape, (side, side))
            self.assertLess(np.abs(found - expected).max(), tolerance)

    def test_computes_what_the_graph_says(self):
        self.assert_same_outputs(read_model(TinyLite().bytes()), SIDE, 1e-5)

    def test_computes_what_the_real_network_says(self):
        path = real_network()
        if path is None:
            self.skipTest("no permissive/selfie_segmentation.tflite (RTD_MODEL_DIR)")
        self.assert_same_outputs(load_model(path), 256, 1e-4)

    def test_describes_the_network(self):
        model, parameters = convert(read_model(TinyLite().bytes()), {"rtd.licence": "Apache-2.0"})
        metadata = {entry.key: entry.value for entry in model.metadata_props}
        self.assertEqual(metadata, {"rtd.decoder": "person_mask", "rtd.licence": "Apache-2.0"})
        self.assertEqual([node.name for node in model.graph.input], ["images"])
        self.assertEqual([node.name for node in model.graph.output], ["person"])
        self.assertGreater(parameters, 200)

    def assert_refused(self, pattern, network):
        data = network if isinstance(network, bytes) else network.bytes()
        with self.assertRaisesRegex(ConversionError, pattern):
            convert(read_model(data))

    def test_refuses_a_file_cut_off_anywhere(self):
        data = TinyLite().bytes()
        for size in range(0, len(data) - 4, 7):
            self.assert_refused("truncated", data[:size])

    def test_refuses_other_files(self):
        self.assert_refused("is not a TensorFlow Lite file", b"")
        self.assert_refused("is not a TensorFlow Lite file", b"\x08\x06" * 100)

    def test_refuses_offsets_out_of_the_file(self):
        data = TinyLite().bytes()
        for root in (1 << 31, 0xFFFFFFFF, len(data) - 2):
            self.assert_refused("truncated or damaged", struct.pack("<I", root) + data[4:])

    def changed(self, name, part, value):
        """A network whose first operator of this name has another part."""
        network = TinyLite()
        next(operator for operator in network.operators if operator[0] == name)[part] = value
        return network

    def test_refuses_other_operators(self):
        self.assert_refused("operator 99 is not one of the operators", self.changed("LOGISTIC", 0, "SOFTMAX"))
        self.assert_refused("has 3 bytes of options", self.changed("CUSTOM", 4, b"abc"))
        strides = struct.pack("<iii", 1, 3, 2)
        self.assert_refused("weights .* and strides", self.changed("CUSTOM", 4, strides))

    def test_refuses_tensors_that_do_not_fit(self):
        self.assert_refused("is not computed before it", self.changed("HARD_SWISH", 1, [60]))
        self.assert_refused("has 0 inputs", self.changed("HARD_SWISH", 1, []))
        self.assert_refused("has 2 outputs", self.changed("HARD_SWISH", 2, [1, 2]))
        self.assert_refused("adds", self.add_of_unlike_tensors())
        network = TinyLite()
        network.tensors[network.outputs[0]][0] = [1, SIDE, SIDE, 2]
        self.assert_refused("its inputs give", network)

    def add_of_unlike_tensors(self):
        network = TinyLite()
        add = next(operator for operator in network.operators if operator[0] == "ADD")
        add[1][1] = network.inputs[0]
        return network

    def test_refuses_shapes_that_cannot_be(self):
        for shape in ([1, -8, 8, 3], [1, 1 << 20, 8, 3], [1] * 5, [1, 4096, 4096, 64], [1, 8, 8, 4], []):
            network = TinyLite()
            network.tensors[network.inputs[0]][0] = shape
            self.assert_refused("shape|numbers|one image", network)

    def test_refuses_weights_of_another_length_or_type(self):
        network = TinyLite()
        network.buffers[1] = network.buffers[1][:-2]
        self.assert_refused("has 214 bytes", network)
        network = TinyLite()
        network.tensors[network.operators[0][1][0]][1] = 9
        self.assert_refused("of type 9", network)
        network.tensors[network.operators[0][1][0]][2] = 10**6
        self.assert_refused("buffer 1000000 of", network)

    def test_refuses_numbers_that_are_none(self):
        network = TinyLite()
        network.buffers[1] = b"\x00\x7c" + network.buffers[1][2:]
        self.assert_refused("infinite or none", network)

    def test_refuses_options_of_other_networks(self):
        steps, kind = ("<i", 1), ("<b", 0)
        self.assert_refused("padding 7", self.changed("CONV_2D", 3, [("<b", 7), steps, steps, kind]))
        self.assert_refused("strides", self.changed("CONV_2D", 3, [kind, ("<i", 0), steps, kind]))
        self.assert_refused("activation 4", self.changed("ADD", 3, [("<b", 4)]))
        dilated = [kind, ("<i", 2), ("<i", 2), kind, ("<i", 2), ("<i", 2)]
        self.assert_refused("is dilated", self.changed("CONV_2D", 3, dilated))
        self.assert_refused("half pixels", self.changed("RESIZE_BILINEAR", 3, [None, None, ("<b", 1), ("<b", 0)]))
        self.assert_refused("averages over", self.changed("AVERAGE_POOL_2D", 3, None))

    def run_tool(self, *arguments):
        command = [TOOLS / "selfie_to_onnx.py", *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_names_what_is_wrong_and_leaves_nothing_behind(self):
        with tempfile.TemporaryDirectory() as folder:
            output, other = pathlib.Path(folder) / "out.onnx", pathlib.Path(folder) / "other.tflite"
            result = self.run_tool("/nowhere.tflite", output)
            self.assertEqual(result.returncode, 1)
            self.assertRegex(result.stderr, "^selfie_to_onnx: /nowhere.tflite: No such file")
            other.write_bytes(TinyLite().bytes())
            self.assertRegex(self.run_tool(other, output).stderr, "SHA-256 is .*, expected 8d13b7fa")
            self.assertFalse(output.exists())
            self.assertEqual(self.run_tool("--any", other, output).returncode, 0)
            self.assertTrue(output.exists())


def real_network():
    path = pathlib.Path(os.environ.get("RTD_MODEL_DIR", "/nowhere")) / "permissive/selfie_segmentation.tflite"
    return path if path.is_file() else None


if __name__ == "__main__":
    unittest.main(verbosity=2)
