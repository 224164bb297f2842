# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Results of RTD-SLAM as NumPy arrays, and runs as generators of poses.

    import rtd_slam as rtd

    run = rtd.open("out")                # the folder of `rtd run --out`
    print(run.poses.position_m[-1], run.frames["inliers"].mean())

    for pose in rtd.run("--source", "synthetic:office"):
        print(pose.stamp_s, pose.position_m)

    for pose in rtd.subscribe():         # of a system that runs already
        print(pose)

Poses are T_world_camera (or T_world_base, if the run had --camera-in-base): metres, unit quaternions x y z w, seconds
as the source stamps them. Needs python3-numpy; `dataframe()` also pandas; `run()` and recordings also the
program rtd (the environment variable RTD_PROGRAM names another).
"""

import builtins
import dataclasses
import json
import os
import pathlib
import select
import shutil
import subprocess
import tempfile
import time

import numpy as np

__all__ = ["Pose", "Poses", "Run", "RtdError", "STATES", "open", "read_poses", "run", "subscribe"]

# msg::TrackingState by number (common/msg/tracking.hpp).
STATES = ("initializing", "ok", "recently lost", "lost", "relocalizing", "predicted", "doubtful", "odometry")
POSE_TOPIC = "/slam/pose"


class RtdError(Exception):
    """A result cannot be read, or rtd failed; the text names the cause."""


@dataclasses.dataclass(frozen=True)
class Pose:
    """One pose of a run in progress."""

    stamp_s: float
    position_m: np.ndarray  # (3,)
    orientation_xyzw: np.ndarray  # (4,)
    frame_id: str  # "map"


def _pandas():
    try:
        import pandas
    except ImportError as error:
        raise ImportError("dataframe() needs pandas: apt install python3-pandas, or pip install pandas") from error
    return pandas


@dataclasses.dataclass(frozen=True, repr=False)
class Poses:
    """N poses in order of time."""

    stamp_ns: np.ndarray  # (N,) int64
    position_m: np.ndarray  # (N, 3)
    orientation_xyzw: np.ndarray  # (N, 4)

    def __len__(self):
        return len(self.stamp_ns)

    @property
    def stamp_s(self):
        """Seconds, (N,); doubles hold present-day stamps to less than a microsecond."""
        return self.stamp_ns * 1e-9

    @property
    def matrices(self):
        """T_world_camera, (N, 4, 4)."""
        x, y, z, w = self.orientation_xyzw.T
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        result = np.tile(np.eye(4), (len(self), 1, 1))
        result[:, :3, :3] = np.moveaxis(np.array(rows), -1, 0)
        result[:, :3, 3] = self.position_m
        return result

    @property
    def path_length_m(self):
        return float(np.linalg.norm(np.diff(self.position_m, axis=0), axis=1).sum())

    def dataframe(self):
        """A pandas.DataFrame, a row per pose: stamp_ns, x, y, z, qx, qy, qz, qw."""
        pandas = _pandas()
        columns = {"stamp_ns": self.stamp_ns, **dict(zip("xyz", self.position_m.T))}
        return pandas.DataFrame({**columns, **dict(zip(("qx", "qy", "qz", "qw"), self.orientation_xyzw.T))})

    def __repr__(self):
        seconds = np.ptp(self.stamp_s) if len(self) else 0.0
        return f"<Poses: {len(self)} in {seconds:.2f} s, path {self.path_length_m:.2f} m>"


class Run:
    """A finished run: the folder that `rtd run --out` wrote. Files are read when they are first asked for."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        if not (self.folder / "run.json").is_file():
            raise RtdError(f"{self.folder}: no run.json in it; give the folder of 'rtd run --out'")
        self._cache = {}

    def _once(self, name, read):
        if name not in self._cache:
            self._cache[name] = read()
        return self._cache[name]

    @property
    def record(self):
        """All of run.json as dictionaries (services/evaluation/README.md)."""
        return self._once("record", lambda: _read_json(self.folder / "run.json"))

    @property
    def figures(self):
        """report.json: ATE, RPE, coverage, latency, ...; empty when no report was written."""
        file = self.folder / "report.json"
        return self._once("figures", lambda: _read_json(file) if file.is_file() else {})

    @property
    def poses(self):
        """The final trajectory: poses of all tracked frames, after the last correction of the map."""
        return self._once("poses", lambda: read_poses(self.folder / "trajectory.txt"))

    @property
    def online_poses(self):
        """The poses as they were published."""
        return self._once("online", lambda: read_poses(self.folder / "trajectory_online.txt"))

    @property
    def keyframes(self):
        """Poses of the keyframes of the map."""
        return self._once("keyframes", lambda: read_poses(self.folder / "keyframes.txt"))

    @property
    def ground_truth(self):
        """The source's own trajectory, or None."""
        file = self.folder / "groundtruth.txt"
        return self._once("truth", lambda: read_poses(file) if file.is_file() else None)

    @property
    def events(self):
        """Restarts, warnings and changes of state, in order: list of str."""
        return list(self.record.get("events", []))

    @property
    def frames(self):
        """Figures of each frame by name: "inliers", "state_name", "slam_stage_ms", ...: arrays of N rows."""
        return self._once("frames", self._read_frames)

    def _read_frames(self):
        columns = {name: np.array(values) for name, values in self.record["frames"].items()}
        names = np.array(STATES + ("unknown",))
        columns["state_name"] = names[np.minimum(columns["state"].astype(int), len(STATES))]
        columns["latency_ms"] = (columns["finished_ns"] - columns["published_ns"]) * 1e-6
        return columns

    def dataframe(self):
        """`frames` as a pandas.DataFrame, a row per frame; columns of several numbers become name_0, name_1, ..."""
        pandas = _pandas()
        flat = {}
        for name, values in self.frames.items():
            if values.ndim == 1:
                flat[name] = values
            else:
                flat.update({f"{name}_{i}": values[:, i] for i in range(values.shape[1])})
        return pandas.DataFrame(flat)

    def __repr__(self):
        return f"<Run {self.folder}: {self.record['source']}, {len(self.frames['seq'])} frames>"


def open(folder):
    """The run in `folder`. Raises RtdError if there is none."""
    return Run(folder)


def read_poses(path, topic=POSE_TOPIC):
    """Poses of a TUM trajectory, or of a recording (MCAP, .db3, .bag; there `topic` is PoseStamped or Odometry).

    Raises RtdError."""
    path = pathlib.Path(path)
    if path.suffix in (".mcap", ".db3", ".bag") or path.is_dir():
        return _poses_of(_messages(["topics", "echo", str(path), topic, "--json"]), f"{path}: {topic}")
    rows = []
    try:
        with builtins.open(path, encoding="utf-8-sig") as file:
            for number, line in enumerate(file, 1):
                fields = line.replace(",", " ").split("#")[0].split()
                if fields:
                    rows.append(_row_of(fields, path, number))
    except (OSError, UnicodeDecodeError) as error:
        raise RtdError(f"{path}: {error}") from error
    return _stacked(rows)


def run(*arguments, out=None, **options):
    """Starts `rtd run ARGUMENTS` and gives its poses (Pose) as they are published; ends with the run.

    `arguments`: options of `rtd run`, but for --out, which is `out`, else a folder that is removed afterwards. Leaving
    the loop ends the run as Ctrl-C does. Raises RtdError when the run fails, with its last lines."""
    if options:
        written = ", ".join(f'"--{name.replace("_", "-")}", {value!r}' for name, value in options.items())
        raise TypeError(f"run() takes options as the command line does: rtd_slam.run({written})")
    return _run(arguments, out)


def subscribe(*arguments):
    """Gives the poses (Pose) of a system that runs already, until the loop is left or `rtd topics` ends.

    `arguments`: where its topics are (--domain, --dds, --robot, ...), as `rtd topics echo` takes them. Waits for poses
    without end. Raises RtdError when they cannot be read."""
    with tempfile.TemporaryFile("w+") as log:
        reader = _echo(arguments, log)
        try:
            for line in reader.stdout:
                yield _live_pose(line)
            if reader.wait():
                raise RtdError(f"rtd topics ended with code {reader.returncode}:\n{_last_lines(log)}")
        finally:
            _end(reader)


def _echo(network, log):
    command = [_program(), "topics", "echo", POSE_TOPIC, "--json", *map(str, network)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True)


def _live_pose(line):
    stamp_ns, position, orientation, frame_id = _pose_of(json.loads(line)["message"])
    return Pose(stamp_ns * 1e-9, position, orientation, frame_id)


def _run(arguments, out):
    folder = out or tempfile.mkdtemp(prefix="rtd-")
    program = _program()
    network = _network_options(arguments)
    log = tempfile.TemporaryFile("w+")
    reader = _echo(network, log)
    child = subprocess.Popen(
        [program, "run", *map(str, arguments), "--out", str(folder)], stdout=log, stderr=subprocess.STDOUT
    )
    try:
        yield from _live_poses(reader, child)
        if child.returncode:
            raise RtdError(f"rtd run ended with code {child.returncode}:\n{_last_lines(log)}")
    finally:
        _end(child)
        _end(reader)
        log.close()
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)


def _live_poses(reader, child):
    ended_s = None
    while True:
        if child.poll() is not None and ended_s is None:
            ended_s = time.monotonic()
        ready, _, _ = select.select([reader.stdout], [], [], 0.2)
        if ready:
            line = reader.stdout.readline()
            if not line:
                break
            yield _live_pose(line)
        elif ended_s is not None and time.monotonic() - ended_s > 1:
            break  # what was on its way has arrived
    child.wait()


def _end(child):
    if child.poll() is None:
        child.send_signal(2)  # SIGINT, as Ctrl-C
        try:
            child.wait(20)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
    if child.stdout:
        child.stdout.close()


def _network_options(arguments):
    """Those of the options of a run that say where its topics are."""
    wanted = ("--profile", "--dds", "--domain", "--interface", "--peers", "--discovery-server", "--robot", "--keystore")
    kept = []
    words = [str(argument) for argument in arguments]
    for index, word in enumerate(words):
        name, equals, _ = word.partition("=")
        if name in wanted:
            kept += [word] if equals else words[index : index + 2]
        elif word == "--secure":
            kept.append(word)
    return kept


def _program():
    wanted = os.environ.get("RTD_PROGRAM", "rtd")
    found = shutil.which(wanted)
    if not found:
        raise RtdError(f"{wanted}: not found; install rtd-slam, or set RTD_PROGRAM, e.g. to build/release/bin/rtd")
    return found


def _messages(arguments):
    done = subprocess.run([_program(), *arguments], capture_output=True, text=True)
    if done.returncode:
        raise RtdError(done.stderr.strip() or f"rtd {arguments[0]} ended with code {done.returncode}")
    return [json.loads(line)["message"] for line in done.stdout.splitlines() if line.startswith("{")]


def _pose_of(message):
    """(stamp_ns, position, orientation, frame_id) of a PoseStamped or an Odometry."""
    header = message["header"]
    pose = message["pose"].get("pose", message["pose"])
    stamp_ns = header["stamp"]["sec"] * 10**9 + header["stamp"]["nanosec"]
    position, orientation = pose["position"], pose["orientation"]
    return (
        stamp_ns,
        np.array([position[axis] for axis in "xyz"]),
        np.array([orientation[axis] for axis in "xyzw"]),
        header["frame_id"],
    )


def _poses_of(messages, name):
    try:
        rows = [(stamp, *position, *orientation) for stamp, position, orientation, _ in map(_pose_of, messages)]
    except (KeyError, TypeError) as error:
        raise RtdError(f"{name}: neither PoseStamped nor Odometry") from error
    return _stacked(rows)


def _row_of(fields, path, number):
    try:
        values = [float(field) for field in fields]
    except ValueError:
        values = []
    if len(values) != 8:
        raise RtdError(f"{path}, line {number}: expected 'stamp tx ty tz qx qy qz qw'")
    seconds, _, fraction = fields[0].partition(".")
    exact = seconds.isdigit() and (fraction or "0").isdigit()
    stamp_ns = int(seconds) * 10**9 + int((fraction + "000000000")[:9]) if exact else round(values[0] * 1e9)
    return (stamp_ns, *values[1:])


def _stacked(rows):
    stamps = np.array([row[0] for row in rows], dtype=np.int64)
    numbers = np.array([row[1:] for row in rows], dtype=float).reshape(-1, 7)
    order = np.argsort(stamps, kind="stable")
    return Poses(stamps[order], numbers[order, :3], numbers[order, 3:])


def _read_json(file):
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RtdError(f"{file}: {error}") from error


def _last_lines(log):
    log.seek(0)
    return "".join(log.readlines()[-5:]).strip()
