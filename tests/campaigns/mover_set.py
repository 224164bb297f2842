#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs a set of rendered sequences with people and carried things, each from several first frames.

Usage: tests/campaigns/mover_set.py --cache FOLDER [--renderer PROGRAM] [--kinds half,mix] [--seeds 1-5]
                                    [--starts 0,20,45] [--modes rtd,geometry,semantic] [--set KEY=VALUE] [--imu SEED]
                                    [--model NETWORK] [--masks truth|NETWORK.onnx] [--jobs N]

A sequence is a folder KIND_SEED in FOLDER: TUM's layout with true masks in mask/. One that is missing is rendered by
`PROGRAM OUT KIND SEED FRAMES`. Choose settings on the odd seeds and judge them on the even ones.
Every run is rtd_offline_run (the whole system in one process, lockstep). It has failed when its ATE is more than three
times that with the true masks, plus 1 cm, or when it has a pose in less than 99 of 100 frames while the masks give it.
OUT/movers.md holds the tables, movers.jsonl every run; runs that are there already are not repeated.
Exit code: 0 all runs ended, 1 one failed to run, 2 a program or a sequence is missing.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import statistics
import subprocess
import sys

import perturbed_runs
import stress

KINDS = "xyz,rpy,static,half,box,empty,crowd,mix"
TRUE_MASKS = "true-mask"
COLUMNS = ["kind", "mode", "runs", "ATE median, m", "worst", "of true masks, median ratio", "failures",
           "coverage, least", "NEES median", "doubtful, most", "precision", "recall"]


def numbers(text: str) -> list:
    """'1-3,7' -> [1, 2, 3, 7]"""
    found = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        found += range(int(first), int(last or first) + 1)
    return found


def render(options, kind: str, seed: int) -> pathlib.Path:
    folder = options.cache / f"{kind}_{seed}"
    if (folder / "groundtruth.txt").exists():
        return folder
    if options.renderer is None:
        raise FileNotFoundError(f"{folder} is missing: name a --renderer")
    print(f"rendering {folder.name}", file=sys.stderr, flush=True)
    subprocess.run([str(options.renderer), str(folder), kind, str(seed), str(options.frames)], check=True,
                   stdout=subprocess.DEVNULL)
    return folder


def command(options, folder: pathlib.Path, mode: str, start: int) -> list:
    task = [str(options.program), "--source", str(folder), "--mode", mode, "--first-frame", str(start)]
    if mode in perturbed_runs.WITH_DETECTOR:
        network = pathlib.Path(options.model).stem
        task += ["--detector", "real", "--detector-model", options.model,
                 "--detections", str(options.cache / f"{folder.name}.{network}.detections")]
        if options.masks:
            task += ["--masks", options.masks, "--remembered-masks", str(options.cache / (folder.name + ".masks"))]
    for setting in options.set:
        task += ["--set", setting]
    if options.imu is not None:
        task += ["--imu-of-truth", str(options.imu)]
    return task


def add_inputs(parser: argparse.ArgumentParser) -> None:
    """What a run has next to the images: command() reads them."""
    parser.add_argument("--model", default="yolov5-lite", help="the detector's network, as --model of rtd run")
    parser.add_argument("--masks", help="people as pixels: truth, or the ONNX file of a network")
    parser.add_argument("--imu", type=int, metavar="SEED",
                        help="with an IMU made of the ground truth, its noise and biases by this seed")


def settings_of(options) -> str:
    return " ".join(options.set + [f"{name}={value}" for name, value in (
        ("imu", options.imu), ("masks", options.masks), ("model", options.model)) if value is not None])


def failed(result: dict, truth: dict) -> bool:
    """Lost where the true masks are not, or far worse than they."""
    if (truth.get("coverage") or 0) >= 0.99 > (result.get("coverage") or 0):
        return True
    return (result.get("ate_m") or 0) > 3 * (truth.get("ate_m") or 0) + 0.01


def row(kind: str, mode: str, results: list, truths: dict) -> list:
    pairs = [(result, truths[(result["sequence"], result["start"])]) for result in results]
    errors = [result["ate_m"] for result in results if result.get("ate_m") is not None]
    ratios = [result["ate_m"] / truth["ate_m"] for result, truth in pairs if result.get("ate_m") and truth.get("ate_m")]
    median = perturbed_runs.median_of
    return [kind, mode, str(len(results)), f"{statistics.median(errors):.4f}" if errors else "-",
            f"{max(errors):.4f}" if errors else "-", f"{statistics.median(ratios):.2f}" if ratios else "-",
            str(sum(failed(result, truth) for result, truth in pairs)),
            f"{min(result.get('coverage') or 0 for result in results):.2f}", median(results, "nees", 1),
            f"{max(result.get('doubtful') or 0 for result in results):.2f}", median(results, "precision"),
            median(results, "recall")]


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cache", type=pathlib.Path, required=True, help="folder of the sequences")
    parser.add_argument("--renderer", type=pathlib.Path, help="renders what is missing there")
    parser.add_argument("--kinds", default=KINDS)
    parser.add_argument("--seeds", type=numbers, default="1-5")
    parser.add_argument("--frames", type=int, default=200, help="of a sequence that is rendered")
    parser.add_argument("--starts", type=numbers, default="0,20,45", help="first frames")
    parser.add_argument("--modes", default="rtd,geometry,semantic")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="filter.* or slam.*")
    add_inputs(parser)
    parser.add_argument("--program", type=pathlib.Path, default=stress.PROGRAM)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--out", type=pathlib.Path, default=stress.ROOT / "build/movers")
    return parser.parse_args()


def run_all(options, cases: list) -> list:
    """The results of (folder, mode, start), as they are on record or by new runs."""
    log = options.out / "movers.jsonl"
    build = stress.build_of(options.program) + settings_of(options)
    known = {}
    if log.exists():
        for result in map(json.loads, log.read_text().splitlines()):
            if result["build"] == build and "failed" not in result:
                known[(result["sequence"], result["mode"], result["start"])] = result
    # The detector looks at a sequence once: the first run with boxes remembers its answers for the others.
    first = {}
    for case in cases:
        if case[1] in perturbed_runs.WITH_DETECTOR:
            first.setdefault(case[0], case)

    def run(case: tuple) -> dict:
        folder, mode, start = case
        names = {"sequence": folder.name, "mode": mode, "start": start}
        if tuple(names.values()) not in known:
            result = stress.run({**names, "build": build}, command(options, folder, mode, start))
            known[tuple(names.values())] = result
            with open(log, "a", encoding="utf-8") as file:
                file.write(json.dumps(result) + "\n")
        return known[tuple(names.values())]

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(run, first.values()))
        return list(pool.map(run, cases))


def tables(options, results: list) -> str:
    truths = {(r["sequence"], r["start"]): r for r in results if r["mode"] == TRUE_MASKS}
    lines = [perturbed_runs.as_line(COLUMNS), "|" + "---|" * len(COLUMNS)]
    for kind in [*options.kinds.split(","), "all"]:
        for mode in [*options.modes.split(","), TRUE_MASKS]:
            of_kind = [r for r in results if r["mode"] == mode and kind in ("all", r["sequence"].rsplit("_", 1)[0])]
            lines.append(perturbed_runs.as_line(row(kind, mode, of_kind, truths)))
    return "\n".join(lines) + "\n"


def main() -> int:
    options = parse()
    options.cache.mkdir(parents=True, exist_ok=True)
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        if not options.program.exists():
            raise FileNotFoundError(f"{options.program} is missing: build it with deploy/test.sh")
        folders = [render(options, kind, seed) for kind in options.kinds.split(",") for seed in options.seeds]
    except (OSError, subprocess.CalledProcessError) as error:
        print(error, file=sys.stderr)
        return 2
    modes = [*options.modes.split(","), TRUE_MASKS]
    results = run_all(options, [(folder, mode, start) for folder in folders for mode in modes
                                for start in options.starts])
    text = tables(options, results)
    (options.out / "movers.md").write_text(text, encoding="utf-8")
    print(text, end="")
    for result in results:
        if "failed" in result:
            print(f"{result['sequence']} {result['mode']} from {result['start']}: {result['failed']}", file=sys.stderr)
    return 1 if any("failed" in result for result in results) else 0


if __name__ == "__main__":
    sys.exit(main())
