#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Measures how far the state and the covariance of a pose can be trusted: docs/integrity.md.

Usage: tests/campaigns/integrity.py --cache FOLDER [--renderer PROGRAM] [--kinds half,mix] [--seeds 1-4]
                                    [--starts 0,15,30,45] [--model NETWORK] [--set KEY=VALUE] [--jobs N]
                                    [--dry-run]

The sequences are those of mover_set.py: a folder KIND_SEED in FOLDER. Every sequence runs from every first frame twice,
as it is and with one fault that is provoked 0.8 s after the first frame: a person or a thing of no class before the
camera, darkness, or blur, each in turn. Every run is rtd_offline_run (the whole system in one process, lockstep).
OUT/integrity.md holds the tables, runs.jsonl every run; runs that are there already are not repeated.
Exit code: 0 the promise is kept, 1 it is not or a run failed, 2 a program or a sequence is missing.
"""
import argparse
import itertools
import os
import pathlib
import shlex
import subprocess
import sys

import mover_set
import perturbed_runs
import stress

FAULTS = {
    "person 20 %": ["--person", "0.2:0.8:2.3"], "thing 20 %": ["--occlude", "0.2:0.8:2.3"],
    "dark 0.4 s": ["--dark", "0.8:1.2"], "person 60 %": ["--person", "0.6:0.8:2.3"],
    "blur 15 px": ["--blur", "15:0.8:1.8"], "thing 40 %": ["--occlude", "0.4:0.8:2.3"],
    "person 80 %": ["--person", "0.8:0.8:2.3"], "dark 1 s": ["--dark", "0.8:1.8"],
    "thing 10 %": ["--occlude", "0.1:0.8:2.3"], "blur 31 px": ["--blur", "31:0.8:1.8"],
    "person 40 %": ["--person", "0.4:0.8:2.3"],
}
PLAIN = "none"
LOST = ("initializing", "recently lost", "lost", "relocalizing")
COLUMNS = ["sequences", "fault", "runs", "frames", "ok, but wrong: of 1000", "of them returning", "needless doubt, %",
           "doubt after, s at most", "never doubted", "NEES of ok, mean", "median run", "ok, %", "doubtful, %",
           "predicted, %", "without pose, %", "covariance grows, doubtful", "predicted", "constant quotient"]


def share(part: float, whole: float) -> float:
    return part / whole if whole else 0.0


class Figures:
    """What many runs together say."""

    def __init__(self, results: list):
        found = [result["integrity"] for result in results]
        self.runs = len(found)
        total = {name: sum(one[name] or 0 for one in found)
                 for name in ("frames", "dangerous", "returning", "good", "needless_doubt", "unnoticed", "nees_frames")}
        self.frames, self.returning, self.unnoticed = total["frames"], total["returning"], total["unnoticed"]
        self.dangerous = share(1000 * total["dangerous"], total["frames"])
        self.needless = share(100 * total["needless_doubt"], total["good"])
        self.delay_s = max((one["delay_s_max"] for one in found if one["delay_s_max"] is not None), default=0.0)
        self.nees = share(sum((one["nees_ok"] or 0) * one["nees_frames"] for one in found), total["nees_frames"])
        medians = sorted(one["nees_ok_median"] for one in found if one["nees_ok_median"] is not None)
        self.nees_median = medians[len(medians) // 2] if medians else 0.0
        self.growth = {state: [sum(one["covariance_" + state][name] for one in found) for name in ("grown", "spans")]
                       for state in ("doubtful", "predicted")}
        self.constant = sum(one["drift"]["nearly_constant"] for one in found)
        self.states = {name: share(100 * sum(one["states"][name] for one in found), total["frames"])
                       for name in (found[0]["states"] if found else {})}

    def row(self, kind: str, fault: str) -> list:
        without = sum(self.states.get(name, 0) for name in LOST)
        return [kind, fault, str(self.runs), str(self.frames), f"{self.dangerous:.1f}", str(self.returning),
                f"{self.needless:.2f}", f"{self.delay_s:.2f}", str(self.unnoticed), f"{self.nees:.1f}",
                f"{self.nees_median:.1f}", *(f"{self.states.get(name, 0):.1f}"
                                             for name in ("ok", "doubtful", "predicted")),
                f"{without:.1f}", *(f"{grown} of {spans}" for grown, spans in self.growth.values()), str(self.constant)]


def kind_of(result: dict) -> str:
    return result["sequence"].rsplit("_", 1)[0]


def table(options, results: list) -> str:
    lines = [perturbed_runs.as_line(COLUMNS), "|" + "---|" * len(COLUMNS)]

    def add(kind: str, fault: str, chosen: list):
        if chosen:
            lines.append(perturbed_runs.as_line(Figures(chosen).row(kind, fault)))

    plain = [result for result in results if result["fault"] == PLAIN]
    provoked = [result for result in results if result["fault"] != PLAIN]
    for kind in options.kinds.split(","):
        add(kind, PLAIN, [result for result in plain if kind_of(result) == kind])
        add(kind, "provoked", [result for result in provoked if kind_of(result) == kind])
    for fault in sorted(FAULTS):
        add("all", fault, [result for result in provoked if result["fault"] == fault])
    add("all", PLAIN, plain)
    add("all", "provoked", provoked)
    add("all", "all", results)
    return "\n".join(lines) + "\n"


def verdicts(options, results: list) -> list:
    """(sentence, whether it holds)"""
    together = Figures(results)
    kinds = {kind: Figures([result for result in results if kind_of(result) == kind])
             for kind in options.kinds.split(",") if any(kind_of(result) == kind for result in results)}
    found = [(f"ok, but wrong: {together.dangerous:.1f} of 1000 frames (at most 1)", together.dangerous <= 1),
             (f"needless doubt: {together.needless:.2f} % of the good frames (at most 1)", together.needless <= 1),
             (f"doubt after {together.delay_s:.2f} s (at most 0.5)", together.delay_s <= 0.5)]
    return found + [(f"NEES of ok, {kind}: {figures.nees:.1f} (3 to 12)", 3 <= figures.nees <= 12)
                    for kind, figures in kinds.items()]


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cache", type=pathlib.Path, required=True, help="folder of the sequences")
    parser.add_argument("--renderer", type=pathlib.Path, help="renders what is missing there")
    parser.add_argument("--kinds", default=mover_set.KINDS)
    parser.add_argument("--seeds", type=mover_set.numbers, default="1-4")
    parser.add_argument("--frames", type=int, default=200, help="of a sequence that is rendered")
    parser.add_argument("--starts", type=mover_set.numbers, default="0,15,30,45", help="first frames")
    parser.add_argument("--mode", default="rtd", help="of the filter")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="filter.* or slam.*")
    mover_set.add_inputs(parser)
    parser.add_argument("--program", type=pathlib.Path, default=stress.PROGRAM)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--dry-run", action="store_true", help="print the commands and run nothing")
    parser.add_argument("--out", type=pathlib.Path, default=stress.ROOT / "build/integrity")
    return parser.parse_args()


def cases(options, folders: list) -> list:
    """(names, command) of each run: plain ones, and as many provoked ones."""
    turns = itertools.cycle(FAULTS)
    tasks = []
    for start, folder in itertools.product(options.starts, folders):
        for fault in (PLAIN, next(turns)):
            names = {"sequence": folder.name, "start": start, "fault": fault, "settings": mover_set.settings_of(options),
                     "mode": options.mode}
            tasks.append((names, mover_set.command(options, folder, options.mode, start) + FAULTS.get(fault, [])))
    return tasks


def key(result: dict) -> tuple:
    return tuple(result[name] for name in ("sequence", "start", "fault", "settings", "mode"))


def run_all(options, tasks: list) -> dict:
    """The first plain run over a sequence remembers what the detector finds there, for all others."""
    build, first = stress.build_of(options.program), {}
    for names, task in tasks:
        if names["fault"] == PLAIN:
            first.setdefault(names["sequence"], (names, task))
    stress.run_all(options, build, list(first.values()), key)
    return stress.run_all(options, build, tasks, key)


def main() -> int:
    options = parse()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        if not options.program.exists():
            raise FileNotFoundError(f"{options.program} is missing: build it with deploy/test.sh")
        folders = [mover_set.render(options, kind, seed) for kind in options.kinds.split(",")
                   for seed in options.seeds]
    except (OSError, subprocess.CalledProcessError) as error:
        print(error, file=sys.stderr)
        return 2
    tasks = cases(options, folders)
    if options.dry_run:
        print("\n".join(shlex.join(task) for _, task in tasks))
        return 0
    done = run_all(options, tasks)
    results = [done[key(names)] for names, _ in tasks]
    good = [result for result in results if "failed" not in result]
    judged = verdicts(options, good)
    text = table(options, good) + "\n" + "".join(
        f"- {'kept' if kept else 'NOT KEPT'}: {sentence}\n" for sentence, kept in judged)
    (options.out / "integrity.md").write_text(text, encoding="utf-8")
    print(text, end="")
    for result in results:
        if "failed" in result:
            print(f"{key(result)}: {result['failed']}", file=sys.stderr)
    return 0 if len(good) == len(results) and all(kept for _, kept in judged) else 1


if __name__ == "__main__":
    sys.exit(main())
