#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs clips several times, each time with another first frame, feature count and boxes a little off.

Usage: tests/campaigns/perturbed_runs.py CLIP [CLIP ...] [--modes rtd,semantic] [--runs 9] [--set KEY=VALUE] [--jobs N]

Prints median and spread. One run says little: a landmark more or less changes a trajectory by tens of percent. CLIP is
a TUM folder or a source URI. Each run is rtd_offline_run (the whole system in one process, lockstep); the boxes of the
detector are kept in FOLDER (`--out`), so that it looks at each clip once; every run but the first moves their edges by
3 % of the box (standard deviation). FOLDER/perturbed.md holds the table, perturbed.jsonl every run.
Exit code: 0 all runs ended, 1 one failed, 2 the program is missing.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import statistics
import sys

import stress

WITH_DETECTOR = ("rtd", "semantic", "epipolar", "rtd-paper")
JITTER = 0.03  # standard deviation of the edges of a box, of its size
COLUMNS = ["clip", "mode", "runs", "ATE median, m", "best", "worst", "as published", "NEES", "coverage, least",
           "precision", "recall"]


def perturbation(run: int) -> list:
    """First frames 0 to 9, 800 to 1200 features; run 0 is the plain one."""
    features = 1000 if run == 0 else 800 + 50 * (7 * run % 9)
    return ["--first-frame", str(run % 10), "--set", f"filter.orb.feature_count={features}"]


def command(clip: str, mode: str, run: int, settings: list, folder: pathlib.Path, model: str) -> list:
    task = [str(stress.PROGRAM), "--source", clip, "--mode", mode, *perturbation(run)]
    if mode in WITH_DETECTOR:
        known = folder / f"{pathlib.Path(clip).name}.{pathlib.Path(model).name}.detections"
        task += ["--detector", "real", "--detector-model", model, "--detections", str(known)]
        task += ["--detector-seed", str(run), "--detector-jitter", "0" if run == 0 else str(JITTER)]
    for setting in settings:
        task += ["--set", setting]
    return task


def median_of(results: list, key: str, digits: int = 3) -> str:
    values = [result[key] for result in results if result.get(key) is not None]
    return f"{statistics.median(values):.{digits}f}" if values else "-"


def row(clip: str, mode: str, results: list) -> list:
    """Of the runs that ended and were tracked."""
    good = [result for result in results if result.get("ate_m") is not None]
    if not good:
        return [clip, mode, "0 of " + str(len(results)), *["-"] * (len(COLUMNS) - 3)]
    errors = sorted(result["ate_m"] for result in good)
    coverage = min(result["coverage"] for result in good)
    return [clip, mode, str(len(good)), f"{statistics.median(errors):.4f}", f"{errors[0]:.4f}", f"{errors[-1]:.4f}",
            median_of(good, "online_ate_m", 4), median_of(good, "nees", 0), f"{coverage:.2f}",
            median_of(good, "precision"), median_of(good, "recall")]


def as_line(cells: list) -> str:
    return "| " + " | ".join(cells) + " |"


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clips", nargs="+", metavar="CLIP")
    parser.add_argument("--modes", default="rtd,semantic,geometry,true-mask")
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="filter.* or slam.*")
    parser.add_argument("--model", default="yolov5-lite", help="the detector's network, as --model of rtd run")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--out", type=pathlib.Path, default=stress.ROOT / "build/perturbed")
    return parser.parse_args()


def main() -> int:
    options = parse()
    if not stress.PROGRAM.exists():
        print(f"{stress.PROGRAM} is missing: build it with deploy/test.sh", file=sys.stderr)
        return 2
    options.out.mkdir(parents=True, exist_ok=True)
    lines = [as_line(COLUMNS), "|" + "---|" * len(COLUMNS)]
    print("\n".join(lines), flush=True)
    failed = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool, open(options.out / "perturbed.jsonl", "w") as log:
        for clip in options.clips:
            for mode in options.modes.split(","):
                name = pathlib.Path(clip).name
                tasks = [command(clip, mode, run, options.set, options.out, options.model)
                         for run in range(options.runs)]
                # The first run asks the detector, the others remember its answers.
                results = [stress.run({"clip": name, "mode": mode, "run": 0}, tasks[0])]
                results += pool.map(lambda run: stress.run({"clip": name, "mode": mode, "run": run}, tasks[run]),
                                    range(1, options.runs))
                log.writelines(json.dumps(result) + "\n" for result in results)
                failed += [result for result in results if "failed" in result]
                lines.append(as_line(row(name, mode, results)))
                print(lines[-1], flush=True)
    (options.out / "perturbed.md").write_text("\n".join(lines) + "\n")
    for result in failed:
        print(f"{result['clip']} {result['mode']} run {result['run']}: {result['failed']}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
