#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs an endless synthetic scene and prints the memory of each process over time.

Usage: deploy/soak.py [--seconds 120] [--rtd build/release/bin/rtd] [--scene office] [--pace asap]

slam's map and the launcher's record of the run grow with their content. The memory of all other processes must stay
constant.
"""
import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def anonymous_mb(pid: int) -> float:
    """Private memory (RssAnon), without pages of shared memory and files."""
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("RssAnon:"):
            return int(line.split()[1]) / 1024
    return 0.0


def children(pid: int) -> dict:
    found = {}
    for entry in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        found[pathlib.Path(f"/proc/{entry}/comm").read_text().strip()] = int(entry)
    return found


def sample(pid: int) -> dict:
    try:
        return {name: anonymous_mb(child) for name, child in {**children(pid), "rtd": pid}.items()}
    except FileNotFoundError:
        return {}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=120)
    parser.add_argument("--rtd", default=str(ROOT / "build/release/bin/rtd"))
    parser.add_argument("--scene", default="office")
    parser.add_argument("--pace", default="asap")
    parser.add_argument("--domain", type=int, default=91)
    options = parser.parse_args()

    with tempfile.TemporaryDirectory(prefix="rtd-soak-") as folder:
        run = subprocess.Popen([options.rtd, "run", "--quiet", "--source", f"synthetic:{options.scene}?frames=0",
                                "--pace", options.pace, "--domain", str(options.domain), "--out", folder],
                               env=os.environ, stdout=subprocess.DEVNULL)
        samples, started = [], time.monotonic()
        while time.monotonic() - started < options.seconds and run.poll() is None:
            time.sleep(5)
            samples.append((time.monotonic() - started, sample(run.pid)))
        run.send_signal(signal.SIGINT)
        run.wait(timeout=30)
        report = json.loads((pathlib.Path(folder) / "report.json").read_text())

    names = sorted(samples[-1][1]) if samples else sys.exit("the run ended before the first sample")
    print("| time s | " + " | ".join(f"{name} MB" for name in names) + " |")
    print("|---" * (len(names) + 1) + "|")
    for elapsed, memory in samples[:: max(1, len(samples) // 8)] + samples[-1:]:
        print(f"| {elapsed:.0f} | " + " | ".join(f"{memory.get(name, 0):.1f}" for name in names) + " |")
    print(f"\n{report['frames_tracked']} frames tracked, {report['map']['keyframes']} keyframes, "
          f"{report['map']['landmarks']} landmarks at the end, {report['frames_per_s']:.1f} frames/s")


if __name__ == "__main__":
    main()
