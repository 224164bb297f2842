#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The programs of tests/campaigns, which no other test starts: their options are known to what reads them."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CAMPAIGNS = pathlib.Path(__file__).resolve().parents[2] / "campaigns"


def run(name: str, *options: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, "-B", str(CAMPAIGNS / name), *options], capture_output=True, text=True,
                          timeout=30)


class CampaignsTest(unittest.TestCase):
    def test_each_says_how_it_is_used(self):
        for program in sorted(CAMPAIGNS.glob("*.py")):
            if "__main__" not in program.read_text(encoding="utf-8"):
                continue
            ended = run(program.name, "--help")
            if "No module named 'cv2'" in ended.stderr:  # OpenCV for Python: of the pictures only
                continue
            self.assertEqual(ended.returncode, 0, program.name + ": " + ended.stderr)
            self.assertIn("usage:", ended.stdout.lower(), program.name)

    def test_integrity_runs_every_sequence_plain_and_provoked(self):
        with tempfile.TemporaryDirectory() as cache:
            for seed in (1, 2):
                folder = pathlib.Path(cache, f"half_{seed}")
                folder.mkdir()
                (folder / "groundtruth.txt").touch()
            ended = run("integrity.py", "--cache", cache, "--kinds", "half", "--seeds", "1,2", "--starts", "0,15",
                        "--model", "some/net.onnx", "--masks", "truth", "--program", sys.executable, "--out", cache,
                        "--dry-run")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        runs = ended.stdout.splitlines()
        self.assertEqual(len(runs), 2 * 2 * 2)
        self.assertTrue(all("--detector-model some/net.onnx" in one and "--masks truth" in one for one in runs))
        self.assertTrue(all("half_1.net.detections" in one for one in runs if "half_1 " in one))
        provoked = [one for one in runs if any(f in one for f in ("--person", "--occlude", "--dark", "--blur"))]
        self.assertEqual(len(provoked), 4)


if __name__ == "__main__":
    unittest.main()
