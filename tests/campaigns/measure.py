#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the clips of docs/results.md several times and prints their accuracy; speed.py measures what they cost.

Usage: tests/campaigns/measure.py [--runs 5] [--rtd build/release/bin/rtd] [--data DIR] [--only NAME ...]

Every figure comes from the report.json of `rtd run`.
"""
import argparse
import hashlib
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLIPS = ("fr1_xyz", "walk_xyz", "walk_rpy", "walk_box")

# name: arguments of `rtd run`
CASES = {f"{clip} {mode}": f"--source tum:{{data}}/{clip} --pace lockstep --filter {mode}"
         for mode in ("rtd", "off", "semantic", "geometry") for clip in CLIPS}

HEAD = "| run | ATE RMSE m | online ATE m | RPE m/s | coverage | peak RSS MB | bytes equal |\n|---|---|---|---|---|---|---|"


def run_once(rtd: str, arguments: str, out: pathlib.Path, domain: int) -> dict:
    command = [rtd, "run", *arguments.split(), "--out", str(out), "--domain", str(domain), "--quiet"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    if finished.returncode != 0:
        sys.exit(f"{' '.join(command)}\nended with {finished.returncode}:\n{finished.stdout}\n{finished.stderr}")
    report = json.loads((out / "report.json").read_text())
    report["trajectory_sha256"] = hashlib.sha256((out / "trajectory.txt").read_bytes()).hexdigest()
    report["peak_rss_sum_mb"] = sum(report["peak_rss_mb"].values())
    return report


def spread(reports: list, pick, digits: int) -> str:
    values = [pick(report) for report in reports]
    if any(value is None for value in values):
        return "-"
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f}..{max(values):.{digits}f})"


def accuracy_row(name: str, reports: list) -> str:
    identical = "yes" if len({report["trajectory_sha256"] for report in reports}) == 1 else "no"
    return " | ".join([
        f"| {name}",
        spread(reports, lambda r: r["ate_rmse_m"], 4),
        spread(reports, lambda r: r.get("ate_online_rmse_m"), 4),
        spread(reports, lambda r: r["rpe_trans_rmse_m"], 4),
        spread(reports, lambda r: r["coverage"], 3),
        spread(reports, lambda r: r["peak_rss_sum_mb"], 0),
        f"{identical} |",
    ])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--rtd", default=str(ROOT / "build/release/bin/rtd"))
    parser.add_argument("--data", default=os.environ.get("RTD_DATA_DIR", str(ROOT.parent / "shared/data")))
    parser.add_argument("--domain", type=int, default=90)
    parser.add_argument("--only", nargs="*", default=[], choices=list(CASES), help="cases to run (default: all)")
    options = parser.parse_args()

    print(f"Median (min..max) of {options.runs} runs\n\n{HEAD}")
    with tempfile.TemporaryDirectory(prefix="rtd-measure-") as folder:
        for name in options.only or CASES:
            reports = []
            for run in range(options.runs):
                print(f"  {name}: run {run + 1} of {options.runs}", file=sys.stderr)
                out = pathlib.Path(folder) / f"{name.replace(' ', '_')}_{run}"
                reports.append(run_once(options.rtd, CASES[name].format(data=options.data), out, options.domain))
            print(accuracy_row(name, reports), flush=True)


if __name__ == "__main__":
    main()
