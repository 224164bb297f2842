#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Prints the table "Speed" of docs/results.md: processor time, throughput, latency, start and memory.

    tests/campaigns/speed.py [--rounds 3] [--only cpu throughput latency busy overload start memory]

The reference is one that everyone has: OpenCV's ORB (1000 features) and OpenCV's RGB-D odometry from frame to frame,
images read from the same files, one thread. It makes no map, so it does less. Both run in turn, round by round; a ratio
is the median of the ratios of all rounds, which a busy machine changes less than the times.

Processor time a frame is that of camera, filter and slam together, without their start: the time of a run of all
frames minus that of a run of 20, for each frame more. Start: from the start of `rtd run` until slam has the first pose,
files in the cache. Memory: the greatest sum over the services, PSS as Linux counts shared pages once.
Needs RTD_DATA_DIR with the clips fr1_xyz and walk_xyz, and for busy and overload the rights to make control groups (or
autogroups). Exit code: 0 all was measured, 1 a run failed.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import threading
import time

import busy_runs

HERE = pathlib.Path(__file__).resolve()
ROOT = HERE.parents[2]
STAGES = ("camera", "filter", "slam")
FEW_FRAMES = 20  # of a run that shows what the start takes
PARTS = ("cpu", "throughput", "latency", "busy", "overload", "start", "memory")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", default=3, type=int, help="(%(default)s)")
    parser.add_argument("--only", nargs="+", default=PARTS, choices=PARTS, help="parts of the table (all)")
    parser.add_argument("--bin", default=ROOT / "build/release/bin", type=pathlib.Path, help="folder of rtd (%(default)s)")
    parser.add_argument("--data", default=os.environ.get("RTD_DATA_DIR", ""), type=pathlib.Path, help="(%(default)s)")
    parser.add_argument("--domain", default=85, type=int, help="DDS domain (%(default)s)")
    parser.add_argument("--reference", metavar="FOLDER", help=argparse.SUPPRESS)
    return parser.parse_args()


def play_reference(folder: pathlib.Path) -> dict:
    """OpenCV on a TUM folder, in this process. All times are of the frames, not of the start."""
    try:
        import cv2
        import numpy
    except ImportError as missing:
        sys.exit(f"speed: {missing}: install python3-opencv and use /usr/bin/python3")
    cv2.setNumThreads(1)
    pairs = [line.split() for line in (folder / "associations.txt").read_text(encoding="utf-8").splitlines()]
    camera = numpy.array([[525, 0, 319.5], [0, 525, 239.5], [0, 0, 1]], numpy.float32)
    orb, odometry = cv2.ORB_create(1000), cv2.rgbd.RgbdOdometry_create(camera)
    before, began_s, began_cpu_s = None, time.monotonic(), time.process_time()
    for _, color, _, depth in pairs:
        gray = cv2.imread(str(folder / color), cv2.IMREAD_GRAYSCALE)
        depth_m = cv2.imread(str(folder / depth), cv2.IMREAD_UNCHANGED).astype(numpy.float32) / 5000
        depth_m[depth_m == 0] = numpy.nan
        orb.detectAndCompute(gray, None)
        frame = cv2.rgbd.OdometryFrame_create(gray, depth_m)
        if before is not None:
            odometry.compute2(before, frame)
        before = frame
    return {"cpu_ms": 1e3 * (time.process_time() - began_cpu_s) / len(pairs),
            "frames_per_s": len(pairs) / (time.monotonic() - began_s)}


def reference(clip: pathlib.Path) -> dict:
    answer = subprocess.run([sys.executable, str(HERE), "--reference", str(clip)], stdout=subprocess.PIPE, check=False)
    if answer.returncode != 0:
        sys.exit(answer.returncode)
    return json.loads(answer.stdout)


class Runs:
    """Runs of rtd, each in a folder that is removed."""

    def __init__(self, args):
        self.args = args

    def play(self, source, options, look=lambda process: None) -> dict:
        """report.json; `start_s` too. `look` is called with the process again and again."""
        with tempfile.TemporaryDirectory(prefix="rtd_speed_") as out:
            command = [str(self.args.bin / "rtd"), "run", "--source", str(source), "--out", out, "--domain",
                       str(self.args.domain), "--quiet", *options]
            began_ns = time.monotonic_ns()
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
                ended = threading.Event()
                looking = threading.Thread(target=lambda: [look(process) for _ in iter(lambda: ended.wait(0.5), True)])
                looking.start()
                output, _ = process.communicate()
                ended.set()
                looking.join()
            if process.returncode != 0:
                sys.exit(f"speed: {' '.join(command)} ended with {process.returncode}: {output.strip()}")
            report = json.loads(pathlib.Path(out, "report.json").read_text(encoding="utf-8"))
            frames = json.loads(pathlib.Path(out, "run.json").read_text(encoding="utf-8"))["frames"]
            report["start_s"] = (min(frames["finished_ns"]) - began_ns) * 1e-9
            return report

    def cpu_ms(self, clip, mode) -> float:
        """Of one frame more."""
        options = ["--pace", "lockstep", "--filter", mode, "--detector", "off"]
        many, few = (self.play(clip, [*options, *some]) for some in ([], ["--frames", str(FEW_FRAMES)]))
        spent_s = [sum(report["cpu_s"][stage] for stage in STAGES) for report in (many, few)]
        return 1e3 * (spent_s[0] - spent_s[1]) / (many["frames_in"] - few["frames_in"])

    def beside_others(self, clip, count, lose=0.0, bursts=0.0) -> dict:
        options = argparse.Namespace(bin=self.args.bin, domain=self.args.domain, options=[], bursts=bursts, own_sessions=True)
        with tempfile.TemporaryDirectory(prefix="rtd_speed_") as out, busy_runs.busy_processes(count, True):
            source = busy_runs.without_some(f"tum:{clip}", lose, out) if lose > 0 else f"tum:{clip}"
            return busy_runs.play(options, str(pathlib.Path(out, "run")), source)


def median(values) -> float:
    return statistics.median(values)


def spread(values, digits=1) -> str:
    """Median, and the least and greatest value."""
    return f"{median(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def row(what, ours, theirs="-", ratio="-", asked="-"):
    print(f"| {what} | {ours} | {theirs} | {ratio} | {asked} |", flush=True)


def compare(what, rounds, asked="-", digits=1):
    """`rounds`: pairs of our value and the reference's."""
    ours, theirs = zip(*rounds)
    row(what, spread(ours, digits), spread(theirs, digits), f"{median([a / b for a, b in rounds]):.2f}", asked)


def measure_cpu(runs, rounds, data):
    for clip, mode in (("fr1_xyz", "off"), ("fr1_xyz", "rtd"), ("walk_xyz", "rtd")):
        pairs = [(runs.cpu_ms(data / clip, mode), reference(data / clip)["cpu_ms"]) for _ in range(rounds)]
        compare(f"processor time a frame, {clip} `{mode}`, no detector, ms", pairs)


def measure_throughput(runs, rounds, data):
    options = ["--pace", "asap", "--detector", "off", "--filter", "rtd"]
    pairs = [(runs.play(data / "fr1_xyz", options)["frames_per_s"], reference(data / "fr1_xyz")["frames_per_s"])
             for _ in range(rounds)]
    compare("frames a second, `asap`, fr1_xyz `rtd`, no detector", pairs)


def measure_latency(runs, rounds, data):
    reports = [runs.play(data / "walk_xyz", ["--pace", "realtime"]) for _ in range(rounds)]
    text = ", ".join(spread([report["latency_ms"][key] for report in reports], 0) for key in ("p50", "p99"))
    row("camera to pose, walk_xyz at 30 Hz with detector, p50, p99, ms", text, asked="18, 33")


def beside_text(reports, quiet) -> str:
    ratios = [report["ate_rmse_m"] / quiet["ate_rmse_m"] for report in reports]
    return (f"coverage {min(report['coverage'] for report in reports):.3f} at least, p99 "
            f"{spread([report['latency_ms']['p99'] for report in reports], 0)} ms, ATE x {spread(ratios, 2)}")


def measure_busy(runs, rounds, data):
    quiet = runs.beside_others(data / "walk_xyz", 0)
    for count in (3, 6):
        reports = [runs.beside_others(data / "walk_xyz", count) for _ in range(rounds)]
        row(f"walk_xyz beside {count} busy processes in groups of their own", beside_text(reports, quiet),
            asked="0.99, 80 ms, x 1.2")


def measure_overload(runs, rounds, data):
    quiet = runs.beside_others(data / "walk_xyz", 0)
    reports = [runs.beside_others(data / "walk_xyz", 6, lose=0.5, bursts=300) for _ in range(rounds)]
    lost = sum(report["events"]["tracking_lost"] for report in reports)
    shares = [report["frames_tracked"] / report["frames_used"] for report in reports]
    row("the same beside 6, half of the frames lost, bursts of 300 ms",
        f"poses of {min(shares):.3f} of the processed frames at least, lost {lost} times, {beside_text(reports, quiet)}",
        asked="0.99, 0 lost, x 1.5")


def measure_start(runs, rounds, data):
    for what, options in (("without detector", ["--detector", "off"]), ("with detector", [])):
        starts = [runs.play(data / "walk_xyz", ["--pace", "realtime", "--frames", "10", *options])["start_s"]
                  for _ in range(3 * rounds)]
        row(f"start to first pose, {what}, s", spread(starts, 2), asked="0.5")


def pss_mb(process: int) -> float:
    try:
        lines = pathlib.Path(f"/proc/{process}/smaps_rollup").read_text(encoding="ascii").splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024


def measure_memory(runs, rounds, data):
    greatest = []

    def look(process):
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
        try:
            services = children.read_text(encoding="ascii").split()
        except OSError:
            return
        greatest.append(sum(pss_mb(int(service)) for service in services))

    reports = [runs.play(data / "walk_xyz", ["--pace", "realtime"], look) for _ in range(rounds)]
    sums = [sum(value for name, value in report["peak_rss_mb"].items() if name != "launcher") for report in reports]
    row("memory of the services, walk_xyz with detector, sum of peak RSS, MB", spread(sums, 0), asked="300")
    row("the same, PSS", f"{max(greatest):.0f}")


def main():
    args = arguments()
    if args.reference:
        print(json.dumps(play_reference(pathlib.Path(args.reference))))
        return
    print("| what | RTD-SLAM | OpenCV | ratio | asked |\n|---|---|---|---|---|")
    for part in PARTS:
        if part in args.only:
            globals()[f"measure_{part}"](Runs(args), args.rounds, args.data)


if __name__ == "__main__":
    main()
