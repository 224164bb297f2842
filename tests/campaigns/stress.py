#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs synthetic scenes with many seeds and reports the worst case of each.

Usage: tests/campaigns/stress.py [--seeds 20] [--scenes fill,slow] [--modes rtd,geometry] [--jobs N] [--out FOLDER]
       tests/campaigns/stress.py faults [--seeds 5] [--faults holes,rolling] [--quick] [--jobs N] [--out FOLDER]

Without a word: every scene with a perfect sensor. `faults`: one scene with a sensor that has faults (camera README,
"A sensor with faults"), each fault alone over its strengths and all combined, in the modes off, semantic, geometry,
rtd and true-mask; names the worst ratio of rtd to the better of semantic and geometry.

--parameters adds to every source, e.g. --parameters imu=1: the camera has an IMU (camera README).

Each run is rtd_offline_run (the whole system in one process, lockstep). FOLDER/runs.jsonl keeps the results: a second
start with the same program repeats no run. FOLDER/stress.md and stress.json contain the tables, of `faults`
faults.md and faults.json.
Exit code: 0 all runs within the limits (`faults`: all runs ended), 1 some are not, 2 the program is missing.
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

import fault_sweep

ROOT = pathlib.Path(__file__).resolve().parents[2]
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


def command(program: pathlib.Path, source: str, mode: str, seed: int) -> list:
    return [os.path.relpath(program), "--source", source, *MODES[mode], "--detector-seed", str(seed)]


def scene_command(options, scene: str, seed: int, mode: str) -> list:
    more = f"&{options.parameters}" if options.parameters else ""
    return command(options.program, f"synthetic:{scene}?{SCENES[scene]}&seed={seed}{more}", mode, seed)


def run(names: dict, task: list) -> dict:
    """What a command measures, with the names of the run added."""
    try:
        done = subprocess.run([*task, "--json"], capture_output=True, text=True, timeout=900)
        if done.returncode == 0:
            return {**names, **json.loads(done.stdout.splitlines()[-1])}
        failed = f"exit code {done.returncode}: {done.stderr.strip()[-200:]}"
    except (subprocess.TimeoutExpired, ValueError, IndexError) as error:
        failed = str(error)[-200:]
    return {**names, "failed": failed}


def key(result: dict) -> tuple:
    return result["scene"], result["seed"], result["mode"], result.get("parameters", "")


def earlier_results(file: pathlib.Path, build: str, key_of) -> dict:
    results = {}
    if file.exists():
        for line in file.read_text().splitlines():
            result = json.loads(line)
            if result["build"] == build and "failed" not in result:
                results[key_of(result)] = result
    return results


def run_all(options, build: str, tasks: list, key_of) -> dict:
    """Runs what has no result yet. `tasks`: (names, command); results by `key_of` their names."""
    file = options.out / "runs.jsonl"
    results = earlier_results(file, build, key_of)
    todo = [(names, task) for names, task in tasks if key_of(names) not in results]
    started = time.monotonic()
    with file.open("a") as log, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        running = [pool.submit(run, *task) for task in todo]
        for done, future in enumerate(concurrent.futures.as_completed(running), 1):
            result = {**future.result(), "build": build}
            results[key_of(result)] = result
            log.write(json.dumps(result) + "\n")
            log.flush()
            left_s = (time.monotonic() - started) / done * (len(todo) - done)
            print(f"\r{done}/{len(todo)} runs, {left_s / 60:.0f} min left ", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return results


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


def add_common_options(parser, out: str):
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at a time")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build" / out)
    parser.add_argument("--program", type=pathlib.Path, default=PROGRAM)


def parse_scene_options(arguments: list):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--scenes", type=choice(SCENES), default=DEFAULT_SCENES, help=", ".join(SCENES))
    parser.add_argument("--modes", type=choice(MODES), default=["rtd", "geometry"], help=", ".join(MODES))
    parser.add_argument("--parameters", default="", help="of every source, joined by &")
    add_common_options(parser, "stress")
    parser.add_argument("--max-ate", type=float, default=0.03, help="m; a run with a larger ATE is listed as a failure")
    parser.add_argument("--min-coverage", type=float, default=0.95, help="a run with less is listed as a failure")
    return parser.parse_args(arguments)


def parse_fault_options(arguments: list):
    faults = fault_sweep.FAULTS
    parser = argparse.ArgumentParser(prog="stress.py faults", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--faults", type=choice(faults), default=list(faults), help=", ".join(faults))
    parser.add_argument("--modes", type=choice(fault_sweep.MODES), default=list(fault_sweep.MODES),
                        help=", ".join(fault_sweep.MODES))
    parser.add_argument("--scene", choices=SCENES, default="office")
    parser.add_argument("--seconds", type=float, default=5, help="of the scene in each run")
    parser.add_argument("--quick", action="store_true",
                        help="two seeds, the middle two strengths of " + ", ".join(fault_sweep.QUICK))
    add_common_options(parser, "stress_faults")
    parser.add_argument("--min-coverage", type=float, default=0.8, help="a run with less counts as lost")
    parser.add_argument("--dry-run", action="store_true", help="print the commands and run nothing")
    options = parser.parse_args(arguments)
    if options.quick:
        options.faults, options.seeds = list(fault_sweep.QUICK), 2
    return options


def build_of(program: pathlib.Path) -> str:
    return hashlib.sha256(program.read_bytes()).hexdigest()[:16]


def sweep_scenes(options) -> int:
    tasks = [({"scene": scene, "seed": seed, "mode": mode, "parameters": options.parameters},
              scene_command(options, scene, seed, mode))
             for seed in range(options.first_seed, options.first_seed + options.seeds)
             for scene in options.scenes for mode in options.modes]
    build = build_of(options.program)
    found = run_all(options, build, tasks, key)
    results = [found[key(names)] for names, _ in tasks]

    summaries = {(scene, mode): summarise([r for r in results if r["scene"] == scene and r["mode"] == mode])
                 for scene in options.scenes for mode in options.modes}
    failures = [(r, cause) for r in results if r["mode"] not in ("off", "semantic") and (cause := defect(r, options))]
    text = table(summaries)
    if failures:
        text += "\n\nOutside the limits:\n\n" + "\n".join(
            f"- {cause}: `{shlex.join(scene_command(options, *key(r)[:3]))}`" for r, cause in failures)
    print(text)
    (options.out / "stress.md").write_text(text + "\n")
    (options.out / "stress.json").write_text(json.dumps(
        {"build": build, "runs": results, "summary": [{"scene": scene, "mode": mode, **s}
                                                      for (scene, mode), s in summaries.items()]}, indent=1) + "\n")
    return 1 if failures else 0


def fault_grid(options) -> list:
    """(fault, strength), first without a fault."""
    grid = [("", 0)]
    for name in options.faults:
        strengths = fault_sweep.FAULTS[name].strengths
        grid += [(name, strength) for strength in (strengths[1:3] if options.quick else strengths)]
    return grid


def fault_command(options, name: str, strength, seed: int, mode: str) -> list:
    source = fault_sweep.source(options.scene, name, strength, seed, options.seconds)
    return [*command(options.program, source, mode, seed), *fault_sweep.options(name, strength)]


def needless(mode: str, name: str) -> bool:
    """Whether a fault of the detector meets a mode without one: the run without a fault stands for it."""
    return bool(name) and bool(fault_sweep.FAULTS[name].options) and mode not in ("semantic", "rtd")


def describe(case: tuple, options) -> str:
    ratio, name, strength, seed, errors = case
    numbers = ", ".join(f"{mode} {fault_sweep.metres(errors[mode])}" for mode in options.modes)
    return (f"{ratio:.2f} at {name or 'no fault'} {strength if name else ''}, seed {seed}: {numbers}\n  "
            f"`{shlex.join(fault_command(options, name, strength, seed, 'rtd'))}`")


def sweep_faults(options) -> int:
    seeds = list(range(options.first_seed, options.first_seed + options.seeds))
    grid = fault_grid(options)

    def line(name, strength, seed, mode):
        cause, how = ("", 0) if needless(mode, name) else (name, strength)
        return shlex.join(fault_command(options, cause, how, seed, mode))

    lines = {line(*point, seed, mode): None for seed in seeds for point in grid for mode in options.modes}
    if options.dry_run:
        print("\n".join(lines))
        return 0
    build = build_of(options.program)
    results = run_all(options, build, [({"command": text}, shlex.split(text)) for text in lines],
                      lambda result: result["command"])
    errors = {point: [{mode: fault_sweep.error_m(results[line(*point, seed, mode)], options.min_coverage)
                       for mode in options.modes} for seed in seeds] for point in grid}
    text = fault_sweep.table(errors, options.modes)
    if {"rtd", *fault_sweep.PARTS} <= set(options.modes):
        cases = fault_sweep.worst_cases(errors, seeds, 10)
        text += "\n\nWorst ratios of rtd to the better of its parts:\n\n" + "\n".join(
            "- " + describe(case, options) for case in cases)
    failed = [results[text_line] for text_line in lines if "failed" in results[text_line]]
    text += "".join(f"\n\nFailed: {result['failed']}: `{result['command']}`" for result in failed)
    print(text)
    write_faults(options, build, text, errors, seeds)
    return 1 if failed else 0


def write_faults(options, build: str, text: str, errors: dict, seeds: list):
    (options.out / "faults.md").write_text(text + "\n")
    rows = [{"fault": name, "strength": strength, "seed": seed,
             "ate_m": {mode: error if error != fault_sweep.LOST else None for mode, error in run_errors.items()}}
            for (name, strength), runs in errors.items() for seed, run_errors in zip(seeds, runs)]
    (options.out / "faults.json").write_text(json.dumps({"build": build, "rows": rows}, indent=1) + "\n")


def main() -> int:
    faults = sys.argv[1:2] == ["faults"]
    options = parse_fault_options(sys.argv[2:]) if faults else parse_scene_options(sys.argv[1:])
    if not options.program.exists():
        print(f"{options.program} is missing: cmake --build build/release --target rtd_offline_run", file=sys.stderr)
        return 2
    options.out.mkdir(parents=True, exist_ok=True)
    return sweep_faults(options) if faults else sweep_scenes(options)


if __name__ == "__main__":
    sys.exit(main())
