# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checkpoint reader and converter: right numbers, clear errors, nothing executed from the file."""

import contextlib
import io
import os
import pathlib
import pickle
import sys
import tempfile
import unittest
import zipfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[3] / "services/detector/tools")]

import cv2  # noqa: E402
import fake_torch  # noqa: E402
import onnx  # noqa: E402
import tiny_yolo  # noqa: E402
import yolov5_to_onnx  # noqa: E402
from yolov5_onnx.checkpoint import load_checkpoint  # noqa: E402
from yolov5_onnx.errors import ConversionError  # noqa: E402

HEADS = ["p3", "p4", "p5"]


def run_network(path, image):
    network = cv2.dnn.readNetFromONNX(str(path))
    network.setInput(image.astype(np.float32))
    return network.forward(HEADS)


class ConverterTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.checkpoint = self.folder / "tiny.pt"
        self.output = self.folder / "tiny.onnx"

    def run_cli(self, *arguments):
        """Exit code and what was written to stderr."""
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
            try:
                code = yolov5_to_onnx.main([str(a) for a in arguments])
            except SystemExit as end:
                code = end.code
        return code, errors.getvalue()

    def assert_refused(self, pattern, *arguments):
        code, errors = self.run_cli(*(arguments or (self.checkpoint, self.output, "--size", "64x96")))
        self.assertNotEqual(code, 0)
        self.assertRegex(errors, pattern)
        self.assertNotIn("Traceback", errors)
        self.assertEqual(list(self.folder.glob("*.onnx*")) + list(self.folder.glob("*.part")), [])

    def save_tiny(self, **extra):
        tiny = tiny_yolo.TinyYolo()
        fake_torch.save(tiny.checkpoint(**extra), self.checkpoint)
        return tiny


class Conversion(ConverterTest):
    def test_computes_what_the_layers_say(self):
        tiny = self.save_tiny()
        self.assertEqual(self.run_cli(self.checkpoint, self.output, "--size", "64x96"), (0, ""))
        image = np.random.RandomState(5).rand(1, 3, 64, 96)
        expected = tiny_yolo.reference(tiny.parts, image)
        for computed, wanted in zip(run_network(self.output, image), expected):
            self.assertEqual(computed.shape, wanted.shape)
            self.assertGreater(np.abs(wanted).max(), 0.5)
            np.testing.assert_allclose(computed, wanted, atol=2e-4)

    def test_describes_classes_and_anchors(self):
        self.save_tiny()
        self.run_cli(self.checkpoint, self.output, "--size", "64x64")
        metadata = {p.key: p.value for p in onnx.load(str(self.output)).metadata_props}
        self.assertEqual(metadata["rtd.class_names"], "person\nbox")
        self.assertEqual(metadata["rtd.heads"].splitlines()[1], "16: 30,61 62,45 59,119")

    def test_prefers_the_averaged_weights(self):
        averaged = tiny_yolo.TinyYolo(seed=2)
        self.save_tiny(ema=averaged.checkpoint()["model"])
        self.run_cli(self.checkpoint, self.output, "--size", "64x64")
        image = np.random.RandomState(5).rand(1, 3, 64, 64)
        wanted = tiny_yolo.reference(averaged.parts, image)[0]
        np.testing.assert_allclose(run_network(self.output, image)[0], wanted, atol=2e-4)

    def test_is_the_same_in_every_run(self):
        self.save_tiny()
        self.run_cli(self.checkpoint, self.output, "--size", "64x64")
        first = self.output.read_bytes()
        self.run_cli(self.checkpoint, self.output, "--size", "64x64")
        self.assertEqual(self.output.read_bytes(), first)


class PublishedCheckpoints(ConverterTest):
    """The converted file computes what the file used in development computes."""

    def check(self, name, size):
        folder = pathlib.Path(os.environ.get("RTD_MODEL_DIR", "/nowhere"))
        source, known = folder / "pt" / f"{name}.pt", folder / f"{name}-raw-{size}.onnx"
        if not source.is_file() or not known.is_file():
            self.skipTest(f"no {source} and {known.name} (RTD_MODEL_DIR)")
        self.assertEqual(self.run_cli(source, self.output, "--size", size), (0, ""))
        height, width = map(int, size.split("x"))
        image = np.random.RandomState(1).rand(1, 3, height, width)
        for computed, wanted in zip(run_network(self.output, image), run_network(known, image)):
            np.testing.assert_allclose(computed, wanted, atol=1e-3)

    def test_yolov5_lite_s(self):
        self.check("v5lite-s", "480x640")

    def test_yolov5_lite_e(self):
        self.check("v5lite-e", "320x320")


class Batches(ConverterTest):
    """Each image of a batch gets what it gets alone."""

    def assert_batch_is_free(self, path, size, counts, alone=None):
        images = np.random.RandomState(1).rand(max(counts), 3, *size)
        single = [run_network(alone or path, images[i : i + 1]) for i in range(len(images))]
        for count in counts:
            for head, together in enumerate(run_network(path, images[:count])):
                self.assertEqual(together.shape[0], count)
                for i in range(count):
                    np.testing.assert_allclose(together[i], single[i][head][0], atol=1e-5)

    def nail(self, path):
        """Writes the batch of 1 into the file, as published files have it."""
        model = onnx.load(str(path))
        shapes = {node.input[1] for node in model.graph.node if node.op_type == "Reshape"}
        for tensor in model.graph.initializer:
            if tensor.name in shapes:
                shape = onnx.numpy_helper.to_array(tensor).copy()
                shape[0] = 1
                tensor.CopyFrom(onnx.numpy_helper.from_array(shape, tensor.name))
        for value in list(model.graph.input) + list(model.graph.output):
            value.type.tensor_type.shape.dim[0].dim_value = 1
        nailed = self.folder / "nailed.onnx"
        onnx.save(model, str(nailed))
        return nailed, len(shapes)

    def test_of_a_converted_network(self):
        self.save_tiny()
        self.assertEqual(self.run_cli(self.checkpoint, self.output, "--size", "64x96"), (0, ""))
        self.assert_batch_is_free(self.output, (64, 96), range(1, 17))

    def check_published(self, name, size, counts):
        known = pathlib.Path(os.environ.get("RTD_MODEL_DIR", "/nowhere")) / name
        if not known.is_file():
            self.skipTest(f"no {known} (RTD_MODEL_DIR)")
        self.assertEqual(self.run_cli("--free-batch", known, self.output), (0, ""))
        self.assert_batch_is_free(self.output, size, counts, alone=known)

    def test_of_yolov5_lite_e_when_freed(self):
        self.check_published("v5lite-e-raw-320x320.onnx", (320, 320), (1, 2, 16))

    def test_of_yolov5_lite_s_when_freed(self):
        self.check_published("v5lite-s-raw-480x640.onnx", (480, 640), (1, 2))

    def free(self, nodes, inputs, outputs, constants=()):
        """Writes a network of these parts, frees it; exit code and errors."""
        make = onnx.helper.make_tensor_value_info
        values = [[make(name, 1, shape) for name, shape in side.items()] for side in (inputs, outputs)]
        arrays = [onnx.numpy_helper.from_array(np.array(a), name) for name, a in dict(constants).items()]
        model = onnx.helper.make_model(
            onnx.helper.make_graph([onnx.helper.make_node(*n) for n in nodes], "g", *values, arrays),
            opset_imports=[onnx.helper.make_opsetid("", 11)],
        )
        source = self.folder / "source"
        source.write_bytes(model.SerializeToString())
        return self.run_cli("--free-batch", source, self.output)

    def test_only_images_are_freed(self):
        nodes = [("Conv", ["x", "w"], ["c"]), ("Mul", ["c", "scalar"], ["y"])]
        inputs = {"x": (1, 3, 4, 4), "w": (4, 3, 1, 1), "scalar": ()}
        weights = {"w": np.ones((4, 3, 1, 1), np.float32)}
        self.assertEqual(self.free(nodes, inputs, {"y": (1, 4, 4, 4)}, weights), (0, ""))
        sizes = [[d.dim_value for d in v.type.tensor_type.shape.dim] for v in onnx.load(str(self.output)).graph.input]
        self.assertEqual(sizes, [[0, 3, 4, 4], [4, 3, 1, 1], []])

    def test_networks_whose_shapes_do_not_fit_are_refused(self):
        nodes = [("Reshape", ["x", "s"], ["r"]), ("Add", ["r", "c"], ["y"])]
        constants = {"s": np.array([1, 3, 16]), "c": np.ones((1, 3, 17), np.float32)}
        for inputs, nodes, constants, cause in (
            ({"x": (1, 3, 4, 4)}, nodes, constants, "shapes do not fit"),
            ({"x": (4, 3, 16)}, [("Relu", ["x"], ["y"])], {}, "'x' has 4 images: only batch 1"),
        ):
            code, errors = self.free(nodes, inputs, {"y": ("batch", "channels", "cells")}, constants)
            self.assertEqual(code, 1)
            self.assertIn(cause, errors)
            self.assertFalse(self.output.exists())

    def test_freeing_undoes_nailing(self):
        self.save_tiny()
        self.run_cli(self.checkpoint, self.output, "--size", "64x96")
        nailed, reshapes = self.nail(self.output)
        self.assertGreater(reshapes, 0)
        freed = self.folder / "freed.onnx"
        self.assertEqual(self.run_cli("--free-batch", nailed, freed), (0, ""))
        self.assert_batch_is_free(freed, (64, 96), (1, 4))

    def test_what_cannot_be_freed_is_refused(self):
        broken = self.folder / "broken"
        broken.write_bytes(b"no network")
        self.assert_refused("not an ONNX file", "--free-batch", broken, self.output)
        self.assert_refused("No such file", "--free-batch", self.folder / "none", self.output)
        make = onnx.helper.make_tensor_value_info
        for shape, text in (([2, 8], "keep images apart"), ([-1, 8], "keep images apart")):
            graph = onnx.helper.make_graph(
                [onnx.helper.make_node("Reshape", ["x", "shape"], ["y"])],
                "g",
                [make("x", 1, (1, 16))],
                [make("y", 1, None)],
                [onnx.numpy_helper.from_array(np.array(shape, np.int64), "shape")],
            )
            broken.write_bytes(onnx.helper.make_model(graph).SerializeToString())
            self.assert_refused(text, "--free-batch", broken, self.output)


class Refusals(ConverterTest):
    def test_missing_file(self):
        self.assert_refused("tiny.pt: No such file")

    def test_no_zip_archive(self):
        self.checkpoint.write_text("<html>404: Not Found</html>")
        self.assert_refused("tiny.pt: not a checkpoint of torch 1.6 or later, or truncated")

    def test_checkpoint_cut_off_anywhere(self):
        self.save_tiny()
        whole = self.checkpoint.read_bytes()
        for size in range(0, len(whole) - 1, len(whole) // 9):
            self.checkpoint.write_bytes(whole[:size])
            self.assert_refused("tiny.pt: ")

    def test_zip_without_a_checkpoint(self):
        with zipfile.ZipFile(self.checkpoint, "w") as archive:
            archive.writestr("readme.txt", "hello")
        self.assert_refused("not a torch checkpoint")

    def test_broken_pickle(self):
        for pickled in (b"", b"\x80\x02}q\x00(X", b"\x80\x02cos", b"garbage", b"\x80\x02Q."):
            with zipfile.ZipFile(self.checkpoint, "w") as archive:
                archive.writestr("archive/data.pkl", pickled)
            self.assert_refused("broken checkpoint")

    def test_missing_tensor_data(self):
        self.save_tiny()
        with zipfile.ZipFile(self.checkpoint) as archive:
            pickled = archive.read("archive/data.pkl")
        with zipfile.ZipFile(self.checkpoint, "w") as archive:
            archive.writestr("archive/data.pkl", pickled)
        self.assert_refused("broken checkpoint")

    def test_tensor_outside_its_data(self):
        for tensor in (
            fake_torch.Tensor(np.zeros(4, np.float32), size=(1 << 40,), stride=(1,)),
            fake_torch.Tensor(np.zeros(4, np.float32), size=(4,), stride=(1,), offset=1),
            fake_torch.Tensor(np.zeros(4, np.float32), size=(4,), stride=(-1,), offset=3),
            fake_torch.Tensor(np.zeros(4, np.float32), size=(2, 2), stride=(1,)),
        ):
            fake_torch.save({"model": tensor}, self.checkpoint)
            self.assert_refused("outside its data")

    def test_unknown_layer(self):
        tiny = tiny_yolo.TinyYolo()
        original = tiny.layers
        tiny.layers = lambda: [(fake_torch.layer("WarpDrive"), -1)] + original()
        fake_torch.save(tiny.checkpoint(), self.checkpoint)
        self.assert_refused("unknown layer type WarpDrive; known are .*Shuffle_Block")

    def test_layer_with_unknown_attributes(self):
        tiny = tiny_yolo.TinyYolo()
        odd = tiny.conv(3, 8)
        odd._modules["conv"].kernel_size = "three"
        original = tiny.layers
        tiny.layers = lambda: [(odd, -1)] + original()
        fake_torch.save(tiny.checkpoint(), self.checkpoint)
        self.assert_refused("layer 0 is not the known Conv")

    def test_state_dict_only(self):
        fake_torch.save({"weight": fake_torch.Tensor(np.zeros(3, np.float32))}, self.checkpoint)
        self.assert_refused("contains no model")

    def test_model_without_detection(self):
        tiny = tiny_yolo.TinyYolo()
        original = tiny.layers
        tiny.layers = lambda: original()[:4]
        checkpoint = tiny.checkpoint()
        fake_torch.save(checkpoint, self.checkpoint)
        self.assert_refused("no Detect layer")

    def test_wrong_checksum(self):
        self.save_tiny()
        self.assert_refused("SHA-256 is [0-9a-f]{64}, expected 00", self.checkpoint, self.output, "--sha256", "00")

    def test_sizes_that_do_not_fit(self):
        self.save_tiny()
        self.assert_refused("multiples of 32", self.checkpoint, self.output, "--size", "100x64")
        self.assert_refused("HEIGHTxWIDTH", self.checkpoint, self.output, "--size", "big")
        self.assert_refused("multiples of 32", self.checkpoint, self.output, "--size", "0x0")

    def test_folder_that_does_not_exist(self):
        self.save_tiny()
        self.assert_refused("cannot write", self.checkpoint, self.folder / "missing" / "out.onnx", "--size", "64x64")


class Call:
    """Pickles as a call of `function`."""

    def __init__(self, function, *arguments):
        self.reduced = (function, arguments)

    def __reduce__(self):
        return self.reduced


class MaliciousCheckpoints(ConverterTest):
    """A pickle may name any function; none of them is called, none is even looked up."""

    def check(self, function, *arguments):
        with zipfile.ZipFile(self.checkpoint, "w") as archive:
            archive.writestr("archive/data.pkl", pickle.dumps({"model": Call(function, *arguments)}, protocol=2))
        self.assert_refused("refused")

    def test_shell_command(self):
        witness = self.folder / "witness"
        self.check(os.system, f"touch {witness}")
        self.assertFalse(witness.exists())

    def test_python_code(self):
        witness = self.folder / "witness"
        self.check(eval, f"open({str(witness)!r}, 'w')")
        self.check(exec, f"open({str(witness)!r}, 'w')")
        self.assertFalse(witness.exists())

    def test_attribute_access_and_import(self):
        self.check(getattr, "text", "upper")
        self.check(__import__, "os")

    def test_functions_of_known_packages_are_inert(self):
        witness = self.folder / "witness"
        pickled = b"\x80\x02cnumpy.testing\nrunstring\n(X%c\x00\x00\x00%s}tR." % (
            len(f"open({str(witness)!r},'w')"),
            f"open({str(witness)!r},'w')".encode(),
        )
        with zipfile.ZipFile(self.checkpoint, "w") as archive:
            archive.writestr("archive/data.pkl", pickled)
        loaded = load_checkpoint(self.checkpoint)
        self.assertEqual(loaded.class_name, "runstring")
        self.assertFalse(witness.exists())

    def test_zip_bomb(self):
        with zipfile.ZipFile(self.checkpoint, "w", zipfile.ZIP_DEFLATED) as archive:
            with archive.open("archive/data.pkl", "w", force_zip64=True) as entry:
                entry.write(b"\x80")
            archive.infolist()[0].file_size = 1 << 40
        with self.assertRaisesRegex(ConversionError, "GiB"):
            load_checkpoint(self.checkpoint)


if __name__ == "__main__":
    unittest.main(verbosity=2)  # names what was skipped, and why
