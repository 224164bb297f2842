# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The Python package: reads what `rtd run --out` writes, starts runs and follows them."""

import itertools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "common" / "python"))

import numpy as np  # noqa: E402
import rtd_slam as rtd  # noqa: E402

TRAJECTORY = "1341846313.654184 1 2 3 0 0 0 1\n1341846313.686156 1 2 4 0 0 0.70710678 0.70710678\n"


class Folder(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return self.folder / name


class Trajectories(Folder):
    def test_stamps_keep_their_nanoseconds(self):
        poses = rtd.read_poses(self.write("trajectory.txt", "1341846313.654184017 1 2 3 0 0 0 1\n"))
        self.assertEqual(poses.stamp_ns[0], 1341846313654184017)

    def test_matrices_turn_and_move(self):
        matrix = rtd.read_poses(self.write("trajectory.txt", TRAJECTORY)).matrices[1]
        np.testing.assert_allclose(matrix @ [1, 0, 0, 1], [1, 3, 4, 1], atol=1e-7)

    def test_poses_are_a_line_and_a_table(self):
        poses = rtd.read_poses(self.write("trajectory.txt", TRAJECTORY))
        self.assertEqual(repr(poses), "<Poses: 2 in 0.03 s, path 1.00 m>")
        with unittest.mock.patch.dict(sys.modules, {"pandas": types.SimpleNamespace(DataFrame=dict)}):
            table = poses.dataframe()
        self.assertEqual(list(table), ["stamp_ns", "x", "y", "z", "qx", "qy", "qz", "qw"])
        self.assertEqual((table["z"][1], table["qw"][0]), (4, 1))
        with unittest.mock.patch.dict(sys.modules, {"pandas": None}):
            self.assertRaisesRegex(ImportError, "needs pandas: apt install", poses.dataframe)

    def test_comments_commas_and_a_byte_order_mark_are_taken(self):
        poses = rtd.read_poses(self.write("a.csv", "\ufeff# stamp x y z\n1.5,1,2,3,0,0,0,1\n"))
        self.assertEqual((len(poses), poses.stamp_ns[0]), (1, 1500000000))

    def test_an_empty_file_has_no_poses(self):
        self.assertEqual(rtd.read_poses(self.write("trajectory.txt", "")).matrices.shape, (0, 4, 4))

    def test_a_broken_line_is_named(self):
        with self.assertRaisesRegex(rtd.RtdError, "line 2: expected"):
            rtd.read_poses(self.write("trajectory.txt", "1 2 3 4 5 6 7 8\n1 2 x\n"))


class Installed(Folder):
    def test_pip_installs_it_with_the_version_of_the_project(self):
        tools = [sys.executable, "-c", "import setuptools, wheel, pip"]
        if subprocess.run(tools, capture_output=True).returncode:
            self.skipTest("needs python3-pip, python3-setuptools and python3-wheel")
        shutil.copytree(ROOT / "common" / "python", self.folder / "python")
        pip = [sys.executable, "-m", "pip", "install", "--no-index", "--no-build-isolation", "--no-deps", "--target"]
        done = subprocess.run([*pip, self.folder / "lib", self.folder / "python"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "lib/rtd_slam/__init__.py").is_file())
        version = re.search(r"project\(rtd_slam VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
        self.assertTrue((self.folder / f"lib/rtd_slam-{version}.dist-info").is_dir())


class Runs(Folder):
    def setUp(self):
        super().setUp()
        frames = {
            "stamp_ns": [1, 2], "published_ns": [0, 0], "finished_ns": [2000000, 3000000], "state": [1, 250],
            "seq": [0, 1], "inliers": [300, 10], "slam_stage_ms": [[1, 2], [3, 4]],
        }  # fmt: skip
        self.write("run.json", json.dumps({"source": "tum:x", "frames": frames, "events": ["slam restarted"]}))
        self.write("trajectory.txt", TRAJECTORY)

    def test_poses_events_and_figures(self):
        run = rtd.open(self.folder)
        self.assertEqual((len(run.poses), run.events, run.figures), (2, ["slam restarted"], {}))
        self.assertIsNone(run.ground_truth)
        self.assertEqual(run.poses.path_length_m, 1)

    def test_frames_are_arrays_with_names_of_states(self):
        frames = rtd.open(self.folder).frames
        self.assertEqual(list(frames["state_name"]), ["ok", "unknown"])
        np.testing.assert_allclose(frames["latency_ms"], [2, 3])
        self.assertEqual(frames["slam_stage_ms"].shape, (2, 2))

    def test_a_folder_without_a_run_is_named(self):
        with self.assertRaisesRegex(rtd.RtdError, "no run.json"):
            rtd.open(self.folder / "nothing")

    def test_states_are_those_of_the_messages(self):
        header = (ROOT / "common/msg/tracking.hpp").read_text()
        names = header.split("to_string(TrackingState state)")[1].split("};")[0]
        self.assertEqual(rtd.STATES, tuple(re.findall(r'"([^"]+)"', names)))


class Options(unittest.TestCase):
    def test_by_name_are_answered_with_how_to_write_them(self):
        with self.assertRaisesRegex(TypeError, re.escape("""run("--source", 'synthetic:office', "--save-map", 'a')""")):
            rtd.run(source="synthetic:office", save_map="a")


class Programs(Folder):
    def setUp(self):
        super().setUp()
        self.program = os.environ.get("RTD_PROGRAM", "")
        if not self.program:
            self.skipTest("RTD_PROGRAM is not set: the program rtd")

    def test_a_run_gives_its_poses(self):
        poses = list(rtd.run("--source", "synthetic:office", "--frames", 40, "--detector", "off", "--domain", 87))
        self.assertGreaterEqual(len(poses), 20)
        self.assertEqual(poses[-1].frame_id, "map")
        self.assertTrue(all(a.stamp_s < b.stamp_s for a, b in zip(poses, poses[1:])))

    def test_a_run_that_fails_says_why(self):
        with self.assertRaisesRegex(rtd.RtdError, "no_such_scene"):
            list(rtd.run("--source", "synthetic:no_such_scene", "--domain", 87))

    def test_a_running_system_gives_its_poses(self):
        command = [self.program, "run", "--source", "synthetic:office?frames=0", "--detector", "off", "--domain", "87"]
        with subprocess.Popen([*command, "--out", str(self.folder / "out")], stdout=subprocess.DEVNULL) as running:
            poses = list(itertools.islice(rtd.subscribe("--domain", 87), 5))
            running.send_signal(signal.SIGINT)
        self.assertTrue(all(pose.frame_id == "map" for pose in poses))
        self.assertLess(poses[0].stamp_s, poses[4].stamp_s)

    def test_a_wrong_option_ends_the_subscription(self):
        with self.assertRaisesRegex(rtd.RtdError, "domain"):
            list(rtd.subscribe("--domain", 5000))

    def test_poses_of_a_recording(self):
        recording = self.folder / "run.mcap"
        out = self.folder / "out"
        for _ in rtd.run("--source", "synthetic:office", "--frames", 20, "--detector", "off", "--pace", "lockstep",
                         "--domain", 87, "--record", recording, out=out):  # fmt: skip
            pass
        recorded, written = rtd.read_poses(recording), rtd.open(out).online_poses
        self.assertEqual(list(recorded.stamp_ns), list(written.stamp_ns))
        np.testing.assert_allclose(recorded.position_m, written.position_m, atol=1e-8)


if __name__ == "__main__":
    unittest.main()
