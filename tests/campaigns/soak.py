#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs an endless synthetic scene and prints the memory of each process over time.

Usage: tests/campaigns/soak.py [--seconds 120] [--rtd build/release/bin/rtd] [--scene office] [--pace asap] [RUN_OPTION ...]
       tests/campaigns/soak.py --simulated-hours 8 --scene "office?fps=5" --dense

With --simulated-hours it ends when the scene has lasted that long; a scene of few frames a second gets through hours
in minutes. Options that are not known here are passed to 'rtd run'. slam's map and the launcher's record of the run
grow with their content. The memory of all other processes must stay constant.
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

ROOT = pathlib.Path(__file__).resolve().parents[2]


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


def frames_per_s(scene_parameters: str) -> float:
    values = dict(part.split("=", 1) for part in scene_parameters.split("&") if "=" in part)
    try:
        return float(values.get("fps", 30))
    except ValueError:
        sys.exit(f"soak: fps={values['fps']} is no number: --scene 'office?fps=2'")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=120)
    parser.add_argument("--simulated-hours", type=float, default=0, help="of the scene, instead of --seconds")
    parser.add_argument("--rtd", default=str(ROOT / "build/release/bin/rtd"))
    parser.add_argument("--scene", default="office")
    parser.add_argument("--pace", default="asap")
    parser.add_argument("--domain", type=int, default=91)
    options, run_options = parser.parse_known_args()

    scene, _, parameters = options.scene.partition("?")
    frames = round(options.simulated_hours * 3600 * frames_per_s(parameters))
    source = f"synthetic:{scene}?frames={frames}&{parameters}".rstrip("&")
    with tempfile.TemporaryDirectory(prefix="rtd-soak-") as folder:
        run = subprocess.Popen([options.rtd, "run", "--quiet", "--source", source, "--pace", options.pace,
                                "--domain", str(options.domain), "--out", folder, *run_options],
                               env=os.environ, stdout=subprocess.DEVNULL)
        samples, started = [], time.monotonic()
        while run.poll() is None and (frames > 0 or time.monotonic() - started < options.seconds):
            time.sleep(5)
            samples.append((time.monotonic() - started, sample(run.pid)))
            if len(samples) % 60 == 0:
                print(f"soak: {samples[-1][0] / 60:.0f} minutes", file=sys.stderr)
        if run.poll() is None:
            run.send_signal(signal.SIGINT)
        run.wait(timeout=120)
        report_file = pathlib.Path(folder) / "report.json"
        if not report_file.exists():
            sys.exit(f"soak: 'rtd run' ended with exit code {run.returncode} and left no report; its message is above")
        report = json.loads(report_file.read_text())

    most = max((len(memory) for _, memory in samples), default=0)
    samples = [(elapsed, memory) for elapsed, memory in samples if most > 0 and len(memory) == most]
    names = sorted(samples[-1][1]) if samples else sys.exit("the run ended before the first sample")
    print("| time s | " + " | ".join(f"{name} MB" for name in names) + " |")
    print("|---" * (len(names) + 1) + "|")
    for elapsed, memory in samples[:: max(1, len(samples) // 8)] + samples[-1:]:
        print(f"| {elapsed:.0f} | " + " | ".join(f"{memory[name]:.1f}" for name in names) + " |")
    print(f"\n{report['frames_tracked']} frames tracked, coverage {report['coverage']:.4f}, "
          f"ATE {report['ate_rmse_m']:.4f} m, {len(report['lost_spans'])} lost spans, {sum(report['restarts'].values())} restarts")
    print(f"{report['map']['keyframes']} keyframes, "
          f"{report['map']['landmarks']} landmarks at the end, {report['frames_per_s']:.1f} frames/s")


if __name__ == "__main__":
    main()
