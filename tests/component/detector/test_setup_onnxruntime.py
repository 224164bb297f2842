# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/setup.sh takes from npm only what has the checksum that it knows."""

import json
import os
import pathlib
import platform
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
VIEWERS = ROOT / "tests/interop/viewers"


class Checksums(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name) / "tree"
        tools = pathlib.Path(folder.name) / "tools"
        (self.tree / "deploy").mkdir(parents=True)
        tools.mkdir()
        for name in ("setup.sh", "environment.sh"):
            shutil.copy(ROOT / "deploy" / name, self.tree / "deploy")
        # A registry that gives another archive; all Debian packages are there, and so are the weights.
        for path, text in (
            (tools / "npm", 'echo other > "$4/com.github.asus4.onnxruntime-0.4.9.tgz"'),
            (tools / "dpkg-query", 'echo "install ok installed"'),
            (self.tree / "deploy/fetch_model.sh", "echo weights"),
        ):
            path.write_text(f"#!/bin/sh\n{text}\n")
            path.chmod(0o755)
        self.environment = os.environ | {
            "PATH": f"{tools}:{os.environ['PATH']}",
            "RTD_MODEL_DIR": str(self.tree),
            "XDG_CACHE_HOME": str(self.tree),
        }

    def setup_sh(self, *options):
        return subprocess.run(
            [self.tree / "deploy/setup.sh", *options],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    def test_another_archive_of_onnxruntime_is_refused(self):
        result = self.setup_sh("--onnxruntime")
        self.assertNotEqual(result.returncode, 0, result.stdout)
        self.assertRegex(result.stderr, "is not the file that this version expects, so nothing of it was installed")
        self.assertFalse((self.tree / "build/onnxruntime").exists())

    @unittest.skipUnless(platform.machine() == "x86_64", "npm has ONNX Runtime for x86-64 only")
    def test_the_normal_setup_continues_without_onnxruntime(self):
        result = self.setup_sh("--product")
        self.assertEqual(result.returncode, 0, result.stderr)
        if "ONNX Runtime: package" in result.stdout:
            self.skipTest("this distribution has a package of ONNX Runtime")
        self.assertRegex(result.stderr, "setup: no ONNX Runtime: the detector computes with OpenCV")
        self.assertFalse((self.tree / "build/onnxruntime").exists())

    def test_the_normal_setup_keeps_the_onnxruntime_that_is_there(self):
        library = self.tree / "build/onnxruntime/lib/libonnxruntime.so"
        library.parent.mkdir(parents=True)
        library.write_text("mine")
        result = self.setup_sh("--product")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, "setup: ONNX Runtime: .*/build/onnxruntime")
        self.assertEqual(library.read_text(), "mine")

    def test_every_package_of_the_viewers_has_a_checksum_and_no_host(self):
        lock = json.loads((VIEWERS / "package-lock.json").read_text())
        wanted = json.loads((VIEWERS / "package.json").read_text())["dependencies"]
        self.assertEqual(lock["packages"][""]["dependencies"], wanted, "run npm install --package-lock-only")
        for name, package in lock["packages"].items():
            if name:
                self.assertTrue(package["integrity"].startswith("sha512-"), name)
                self.assertNotIn("resolved", package, name)


if __name__ == "__main__":
    unittest.main()
