# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/setup.sh takes from npm only what has the checksum that it knows."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
VIEWERS = ROOT / "tests/interop/viewers"


class Checksums(unittest.TestCase):
    def test_another_archive_of_onnxruntime_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            tree, tools = pathlib.Path(folder) / "tree", pathlib.Path(folder) / "tools"
            (tree / "deploy").mkdir(parents=True)
            tools.mkdir()
            for name in ("setup.sh", "environment.sh"):
                shutil.copy(ROOT / "deploy" / name, tree / "deploy")
            # A registry that gives another archive; all Debian packages are there.
            for name, text in (
                ("npm", 'echo other > "$4/com.github.asus4.onnxruntime-0.4.9.tgz"'),
                ("dpkg-query", 'echo "install ok installed"'),
            ):
                (tools / name).write_text(f"#!/bin/sh\n{text}\n")
                (tools / name).chmod(0o755)
            environment = os.environ | {"PATH": f"{tools}:{os.environ['PATH']}"}
            result = subprocess.run(
                [tree / "deploy/setup.sh", "--onnxruntime"], env=environment, capture_output=True, text=True, timeout=60
            )
            self.assertNotEqual(result.returncode, 0, result.stdout)
            self.assertRegex(result.stderr, "is not the file that this version expects, so nothing of it was installed")
            self.assertFalse((tree / "build/onnxruntime").exists())

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
