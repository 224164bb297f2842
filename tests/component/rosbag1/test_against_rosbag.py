# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Bags that Debian's rosbag writes: our reader gives the same messages, rtd-camera the same pixels, stamps and truth.

Usage: test_against_rosbag.py BAG_DUMP RTD_RECORDING"""

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

SKIPPED = 77
try:
    import cv2
    import numpy as np
    import rosbag
    import rospy
    from genpy.dynamic import generate_dynamic
    from geometry_msgs.msg import TransformStamped
    from sensor_msgs.msg import CameraInfo, CompressedImage, Image
    import geometry_msgs.msg
except ImportError as error:
    print(f"skipped: {error}; install python3-rosbag python3-sensor-msgs python3-opencv")
    sys.exit(SKIPPED)

BAG_DUMP, RTD_RECORDING = sys.argv[1:3]
WIDTH, HEIGHT, FRAMES = 64, 48, 12
COLOR, DEPTH, INFO = "/camera/rgb/image_color", "/camera/depth/image", "/camera/rgb/camera_info"


def tf_message_class():
    """tf/tfMessage, as TUM's bags have it; Debian has no Python package of it."""
    rule = "=" * 80
    text = "geometry_msgs/TransformStamped[] transforms\n"
    text += f"{rule}\nMSG: geometry_msgs/TransformStamped\n{geometry_msgs.msg.TransformStamped._full_text}"
    return generate_dynamic("tf/tfMessage", text)["tf/tfMessage"]


TfMessage = tf_message_class()


def stamp(frame, offset_ns=0):
    return rospy.Time(1305031102, 175304000 + 33_000_000 * frame + offset_ns)


def header(message, time):
    message.header.stamp = time
    message.header.frame_id = "/openni_rgb_optical_frame"
    return message


def raw_image(pixels, encoding, time):
    message = header(Image(), time)
    message.height, message.width = pixels.shape[:2]
    message.encoding, message.data = encoding, pixels.tobytes()
    message.step = len(message.data) // message.height
    return message


def compressed_image(pixels, encoding, extension, time):
    message = header(CompressedImage(), time)
    message.format = encoding
    message.data = cv2.imencode(extension, pixels)[1].tobytes()
    return message


def camera_info():
    message = header(CameraInfo(), stamp(0))
    message.height, message.width, message.distortion_model = HEIGHT, WIDTH, "plumb_bob"
    message.D = [0.1, -0.2, 0.001, 0.002, 0.3]
    message.K = [52.5, 0, 31.5, 0, 53.5, 23.5, 0, 0, 1]
    return message


def transform(parent, child, time, x):
    message = TransformStamped()
    message.header.stamp, message.header.frame_id, message.child_frame_id = time, parent, child
    message.transform.translation.x, message.transform.rotation.w = x, 1
    return message


def transforms(frame):
    return TfMessage([
        transform("/world", "/kinect", stamp(frame), 0.1 * frame),
        transform("/kinect", "/openni_camera", stamp(frame), 10),
        transform("/openni_camera", "/openni_rgb_optical_frame", stamp(frame), 100),
    ])


def fnv1a(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


class AgainstRosbag(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.bag = self.folder / "x.bag"
        random = np.random.default_rng(1)
        self.colors = [random.integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8) for _ in range(FRAMES)]
        self.depths_mm = [random.integers(400, 9000, (HEIGHT, WIDTH)).astype(np.uint16) for _ in range(FRAMES)]

    def write(self, color, depth, compression="none", names=(COLOR, DEPTH, INFO)):
        """color and depth make the message of a frame; depth comes 5 ms later than colour."""
        with rosbag.Bag(self.bag, "w", compression=compression, chunk_threshold=40_000) as bag:
            bag.write(names[2], camera_info(), stamp(0))
            for i in range(FRAMES):
                bag.write("/tf", transforms(i), stamp(i, 1000))
                bag.write(names[0], color(i), stamp(i, 2000))
                bag.write(names[1], depth(i), stamp(i, 5_000_000))

    def write_plain(self, compression="none"):
        self.write(
            lambda i: raw_image(self.colors[i][:, :, ::-1], "rgb8", stamp(i)),
            lambda i: raw_image(self.depths_mm[i], "16UC1", stamp(i, 5_000_000)),
            compression,
        )

    def export(self, parameters="", code=0):
        out = self.folder / "out"
        command = [RTD_RECORDING, "convert", f"bag:{self.bag}{parameters}", f"tum:{out}"]
        result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(result.returncode, code, result.stderr)
        return out

    def check(self, out, colors, depths):
        lines = (out / "associations.txt").read_text().splitlines()
        self.assertEqual(len(lines), FRAMES)
        for i, line in enumerate(lines):
            _, color, _, depth = line.split()
            self.assertEqual(line.split()[0], f"{stamp(i).secs}.{stamp(i).nsecs // 1000:06d}")
            np.testing.assert_array_equal(cv2.imread(str(out / color), cv2.IMREAD_UNCHANGED), colors[i])
            np.testing.assert_array_equal(cv2.imread(str(out / depth), cv2.IMREAD_UNCHANGED), depths[i])

    def test_gives_the_messages_that_rosbag_gives(self):
        for compression in ("none", "bz2", "lz4"):
            with self.subTest(compression):
                self.write_plain(compression)
                expected = []
                with rosbag.Bag(self.bag) as bag:
                    for topic, (kind, data, *_), time in bag.read_messages(raw=True):
                        expected.append(f"{time.to_nsec()} {topic} {kind} {len(data)} {fnv1a(data):016x}")
                self.assertEqual(len(expected), 3 * FRAMES + 1)
                result = subprocess.run([BAG_DUMP, self.bag], capture_output=True, text=True, timeout=60, check=True)
                self.assertEqual(sorted(result.stdout.splitlines()), sorted(expected))
                self.assertEqual(result.stderr, "")

    def test_plays_tums_encodings(self):
        metres = [d.astype(np.float32) / 1000 for d in self.depths_mm]
        for d in metres:
            d[3, 4], d[3, 5], d[3, 6], d[3, 7] = np.nan, np.inf, -1, 13.2
        self.write(
            lambda i: raw_image(self.colors[i][:, :, ::-1], "rgb8", stamp(i)),
            lambda i: raw_image(metres[i], "32FC1", stamp(i, 5_000_000)),
            "lz4",
        )
        depths = [d * 5 for d in self.depths_mm]
        for d in depths:
            d[3, 4:8] = 0
        out = self.export()
        self.check(out, self.colors, depths)
        text = (out / "calibration.yaml").read_text()
        for line in ("fx: 52.5", "fy: 53.5", "cx: 31.5", "k1: 0.1", "p2: 0.002", "k3: 0.3", "depth_factor: 5000"):
            self.assertIn(line + "\n", text)

    def test_gives_the_truth_of_the_colour_camera(self):
        self.write_plain()
        lines = (self.export() / "groundtruth.txt").read_text().splitlines()[1:]
        self.assertEqual(len(lines), FRAMES)
        self.assertEqual([float(v) for v in lines[3].split()[1:]], [110.3, 0, 0, 0, 0, 0, 1])

    def test_plays_millimetres(self):
        self.write_plain("bz2")
        out = self.export()
        self.check(out, self.colors, self.depths_mm)
        self.assertIn("depth_factor: 1000\n", (out / "calibration.yaml").read_text())

    def test_plays_bgr_and_mono(self):
        for encoding, pixels in (("bgr8", lambda c: c), ("mono8", lambda c: np.ascontiguousarray(c[:, :, 1]))):
            with self.subTest(encoding):
                self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
                self.bag = self.folder / "x.bag"
                self.write(
                    lambda i: raw_image(pixels(self.colors[i]), encoding, stamp(i)),
                    lambda i: raw_image(self.depths_mm[i], "16UC1", stamp(i)),
                )
                grey = [np.repeat(c[:, :, 1:2], 3, axis=2) for c in self.colors]
                self.check(self.export(), grey if encoding == "mono8" else self.colors, self.depths_mm)

    def test_plays_compressed_images_of_topics_named(self):
        def compressed_depth(i):
            message = compressed_image(self.depths_mm[i], "16UC1; compressedDepth", ".png", stamp(i))
            message.data = struct.pack("<iff", 0, 0, 0) + message.data
            return message

        self.write(
            lambda i: compressed_image(self.colors[i], "bgr8; png compressed bgr8", ".png", stamp(i)),
            compressed_depth,
            names=("/a/compressed", "/b/compressedDepth", "/c"),
        )
        out = self.export("?color=/a/compressed&depth=/b/compressedDepth&info=/c")
        self.check(out, self.colors, self.depths_mm)

    def test_plays_inverse_depth(self):
        a, b = 3000.0, 2.0
        inverse = [np.round(a / (d / 1000) + b).astype(np.uint16) for d in self.depths_mm]

        def compressed_depth(i):
            message = compressed_image(inverse[i], "32FC1; compressedDepth png", ".png", stamp(i))
            message.data = struct.pack("<iff", 0, a, b) + message.data
            return message

        self.write(
            lambda i: compressed_image(self.colors[i], "bgr8; png compressed bgr8", ".png", stamp(i)), compressed_depth,
        )
        out = self.export()
        depth = sorted((out / "depth").iterdir())[5]
        got_m = cv2.imread(str(depth), cv2.IMREAD_UNCHANGED) / 5000
        step_m = (self.depths_mm[5] / 1000) ** 2 / a
        np.testing.assert_array_less(np.abs(got_m - self.depths_mm[5] / 1000), step_m + 0.0002)

    def test_a_bag_that_was_not_closed_plays_its_whole_chunks(self):
        self.write_plain("lz4")
        whole = self.bag.read_bytes()
        self.bag.write_bytes(whole[: len(whole) * 2 // 3])
        lines = (self.export(code=3) / "associations.txt").read_text().splitlines()
        self.assertGreater(len(lines), FRAMES // 3)
        self.assertLess(len(lines), FRAMES)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
