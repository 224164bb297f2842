#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs every synthetic scene with many seeds and reports the worst case of each.

Usage: deploy/stress.py [--seeds 20] [--scenes fill,slow] [--modes rtd,geometry] [--jobs N] [--out FOLDER]

Each run is rtd_offline_run (the whole system in one process, lockstep). FOLDER/runs.jsonl keeps the results: a second
start with the same program repeats no run. FOLDER/stress.md and stress.json contain the tables.
Exit code: 0 all runs within the limits, 1 some are not, 2 the program is missing.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/bench/rtd_offline_run"
# Long enough for the plot of each scene, short enough for many seeds.
SCENES = {"sitting": "frames=270&sit=3", "crowd": "frames=180", "fill": "frames=240", "approach": "frames=180",
          "slow": "frames=210", "flicker": "frames=180", "office": "frames=180", "box": "frames=180",
          "static": "frames=150"}
DEFAULT_SCENES = ["sitting", "crowd", "fill", "approach", "slow", "flicker"]
MODES = {"off": ["--mode", "off"], "true-mask": ["--mode", "true-mask"], "geometry": ["--mode", "geometry"],
         "semantic": ["--mode", "semantic", "--detector", "truth"], "rtd": ["--mode", "rtd", "--detector", "truth"],
         "rtd-5hz": ["--mode", "rtd", "--detector", "truth", "--detector-hz", "5", "--detector-delay-ms", "80"],
         "rtd-gap": ["--mode", "rtd", "--detector", "truth", "--detector-outage", "2:3"],
         "rtd-lying": ["--mode", "rtd", "--detector", "lying"], "rtd-real": ["--mode", "rtd", "--detector", "real"]}


def command(program: pathlib.Path, scene: str, seed: int, mode: str) -> list:
    source = f"synthetic:{scene}?{SCENES[scene]}&seed={seed}"
    return [os.path.relpath(program), "--source", source, *MODES[mode], "--detector-seed", str(seed)]


def run(program: pathlib.Path, scene: str, seed: int, mode: str) -> dict:
    result = {"scene": scene, "seed": seed, "mode": mode}
    try:
        done = subprocess.run([*command(program, scene, seed, mode), "--json"], capture_output=True, text=True,
                              timeout=900)
        if done.returncode == 0:
            return {**result, **json.loads(done.stdout.splitlines()[-1])}
        result["failed"] = f"exit code {done.returncode}: {done.stderr.strip()[-200:]}"
    except (subprocess.TimeoutExpired, ValueError, IndexError) as error:
        result["failed"] = str(error)[-200:]
    return result


def key(result: dict) -> tuple:
    return result["scene"], result["seed"], result["mode"]


def earlier_results(file: pathlib.Path, build: str) -> dict:
    results = {}
    if file.exists():
        for line in file.read_text().splitlines():
            result = json.loads(line)
            if result["build"] == build and "failed" not in result:
                results[key(result)] = result
    return results


def run_all(options, build: str) -> list:
    file = options.out / "runs.jsonl"
    results = earlier_results(file, build)
    wanted = [(scene, seed, mode) for seed in range(options.first_seed, options.first_seed + options.seeds)
              for scene in options.scenes for mode in options.modes]
    todo = [task for task in wanted if task not in results]
    started = time.monotonic()
    with file.open("a") as log, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        running = [pool.submit(run, options.program, *task) for task in todo]
        for done, future in enumerate(concurrent.futures.as_completed(running), 1):
            result = {**future.result(), "build": build}
            results[key(result)] = result
            log.write(json.dumps(result) + "\n")
            log.flush()
            left_s = (time.monotonic() - started) / done * (len(todo) - done)
            print(f"\r{done}/{len(todo)} runs, {left_s / 60:.0f} min left ", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return [results[task] for task in wanted]


def defect(result: dict, options) -> str:
    """Why a run fails; empty if it passes."""
    if "failed" in result:
        return result["failed"]
    if result["ate_m"] is None:
        return "no trajectory"
    causes = []
    if result["ate_m"] > options.max_ate:
        causes.append(f"ATE {result['ate_m']:.4f} m")
    if result["coverage"] < options.min_coverage:
        causes.append(f"coverage {result['coverage']:.3f}")
    return ", ".join(causes)


def worst(results: list, name: str, largest: bool):
    """(value, seed) of the worst run; runs without the figure do not count."""
    found = [(r[name], r["seed"]) for r in results if r.get(name) is not None]
    return (max(found) if largest else min(found)) if found else (None, None)


def summarise(results: list) -> dict:
    summary = {"runs": len(results), "failed": sum("failed" in r for r in results)}
    for name, largest in (("ate_m", True), ("max_error_m", True), ("coverage", False), ("precision", False),
                          ("recall", False)):
        value, seed = worst(results, name, largest)
        values = [r[name] for r in results if r.get(name) is not None]
        summary[name] = {"worst": value, "seed": seed, "median": statistics.median(values) if values else None}
    return summary


def cell(figure: dict, digits: int) -> str:
    if figure["worst"] is None:
        return "–"
    return f"**{figure['worst']:.{digits}f}** ({figure['seed']}) / {figure['median']:.{digits}f}"


def table(summaries: dict) -> str:
    lines = ["Worst (its seed) / median over the seeds.", "",
             "| scene | mode | runs | ATE m | largest error m | coverage | precision | recall |", "|" + "---|" * 8]
    for (scene, mode), s in summaries.items():
        lines.append(f"| {scene} | {mode} | {s['runs']}{' (' + str(s['failed']) + ' failed)' if s['failed'] else ''} | "
                     f"{cell(s['ate_m'], 4)} | {cell(s['max_error_m'], 3)} | {cell(s['coverage'], 3)} | "
                     f"{cell(s['precision'], 3)} | {cell(s['recall'], 3)} |")
    return "\n".join(lines)


def choice(known: dict):
    def parse(text: str) -> list:
        names = text.split(",")
        unknown = [name for name in names if name not in known]
        if unknown:
            raise argparse.ArgumentTypeError(f"unknown {unknown[0]!r}; known: {', '.join(known)}")
        return names
    return parse


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--scenes", type=choice(SCENES), default=DEFAULT_SCENES, help=", ".join(SCENES))
    parser.add_argument("--modes", type=choice(MODES), default=["rtd", "geometry"], help=", ".join(MODES))
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/stress")
    parser.add_argument("--program", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--max-ate", type=float, default=0.03, help="m; a run with a larger ATE is listed as a failure")
    parser.add_argument("--min-coverage", type=float, default=0.95, help="a run with less is listed as a failure")
    return parser.parse_args()


def main() -> int:
    options = parse_options()
    if not options.program.exists():
        print(f"{options.program} is missing: cmake --build build/release --target rtd_offline_run", file=sys.stderr)
        return 2
    options.out.mkdir(parents=True, exist_ok=True)
    build = hashlib.sha256(options.program.read_bytes()).hexdigest()[:16]
    results = run_all(options, build)

    summaries = {(scene, mode): summarise([r for r in results if r["scene"] == scene and r["mode"] == mode])
                 for scene in options.scenes for mode in options.modes}
    failures = [(r, cause) for r in results if r["mode"] not in ("off", "semantic") and (cause := defect(r, options))]
    text = table(summaries)
    if failures:
        text += "\n\nOutside the limits:\n\n" + "\n".join(
            f"- {cause}: `{shlex.join(command(options.program, *key(r)))}`" for r, cause in failures)
    print(text)
    (options.out / "stress.md").write_text(text + "\n")
    (options.out / "stress.json").write_text(json.dumps(
        {"build": build, "runs": results, "summary": [{"scene": scene, "mode": mode, **s}
                                                      for (scene, mode), s in summaries.items()]}, indent=1) + "\n")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
