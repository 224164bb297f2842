#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions that each stage takes for a frame: a measure of cost that no load of the machine changes.

    tests/bench/instructions/count.py [--build build/release] [--only NAME ...] [--frames N] [--record]

Each clip is played by bench/rtd_offline_run, one thread, under valgrind's callgrind. The counts are compared with those
in counts.json, recorded per compiler and vector instructions: a stage with more than 1.1 times its count fails.
--record writes the counts instead; commit counts.json with the change that needs more, and say there what the
instructions buy, or with a change that needs less, so that it stays.

Stages: camera (read and decode a frame), orb (features), judge (what moves), tracking and mapping (slam). `apart` is
all that is done once: start, end and evaluation of the program, not per frame.

Needs valgrind and RTD_DATA_DIR with the clips fr1_xyz and walk_xyz. The boxes of walk_xyz are remembered in
walk_xyz_boxes.json, no detector runs. Takes a minute on two idle cores.
Exit codes: 0 no stage needs more, 1 one does, 2 a run failed, 77 nothing could be compared.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import queue
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent.parent
COUNTS = HERE / "counts.json"
FRAMES = 40
MOST = 1.1  # times the recorded count
SKIPPED = 77
RUNS = {  # name: clip, options
    "fr1_xyz off": ("fr1_xyz", ["--mode", "off", "--detector", "off"]),
    "fr1_xyz rtd": ("fr1_xyz", ["--mode", "rtd", "--detector", "off"]),
    "walk_xyz rtd": ("walk_xyz", ["--mode", "rtd", "--detector", "truth",
                                  "--detections", str(HERE / "walk_xyz_boxes.json")]),
}
CAMERA, ORB = "rtd::camera::PlayedSource::read_next(", "rtd::filter::OrbExtractor::extract("
JUDGE = "rtd::filter::DynamicFilter::judge("
SLAM, MAPPING = "rtd::slam::SlamSystem::process(", "rtd::slam::Mapper::insert("
STAGES = ("camera", "orb", "judge", "tracking", "mapping", "all")


class RunFailed(Exception):
    pass


def inclusive_counts(profile: pathlib.Path, functions: tuple) -> tuple:
    """({function: (calls, instructions with all that it calls)}, instructions of the program)."""
    found = {name: [0, 0] for name in functions}
    total, caller, callee = 0, "", None
    with profile.open(errors="replace") as lines:
        for line in lines:
            if line.startswith("fn="):
                caller = line[3:]
            elif line.startswith("cfn="):
                callee = next((name for name in functions if line.startswith(name, 4)), None)
                if callee and caller.startswith(callee):
                    callee = None  # already counted
            elif line.startswith("calls=") and callee:
                calls, instructions = int(line[6:].split()[0]), int(next(lines).split()[1])
                found[callee][0] += calls
                found[callee][1] += instructions
                callee = None
            elif line.startswith("summary:"):
                total = int(line.split()[1])
    return found, total


def stages_of(profile: pathlib.Path) -> dict:
    """{stage: instructions a frame} and the instructions `apart`, in millions."""
    found, total = inclusive_counts(profile, (CAMERA, ORB, JUDGE, SLAM, MAPPING))
    for name in (CAMERA, ORB, SLAM, MAPPING):
        if found[name][0] == 0:
            raise RunFailed(f"{name}...) was never called: renamed or inlined? Name the stage's function in {__file__}")
    frames = found[SLAM][0]
    of_frame = {name: instructions / frames for name, (_, instructions) in found.items()}
    of_frame[CAMERA] = found[CAMERA][1] / found[CAMERA][0]  # it reads ahead
    stages = {"camera": of_frame[CAMERA], "orb": of_frame[ORB], "judge": of_frame[JUDGE],
              "tracking": of_frame[SLAM] - of_frame[MAPPING], "mapping": of_frame[MAPPING]}
    stages["all"] = sum(stages.values())
    stages["apart"] = total - sum(instructions for name, (_, instructions) in found.items() if name != MAPPING)
    return {name: round(count * 1e-6, 2) for name, count in stages.items()}


def count(program: pathlib.Path, name: str, frames: int, cpu: int) -> dict:
    """On one processor, so that no library starts threads: callgrind counts calls within a thread only."""
    clip, options = RUNS[name]
    with tempfile.TemporaryDirectory(prefix="rtd_instructions_") as folder:
        profile = pathlib.Path(folder) / "profile"
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}", "--compress-strings=no",
                   "--compress-pos=no", str(program), "--source", f"tum:{pathlib.Path(os.environ['RTD_DATA_DIR']) / clip}",
                   "--frames", str(frames), *options]
        threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "OPENCV_FOR_THREADS_NUM": "1"}
        finished = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **threads},
                                  preexec_fn=lambda: os.sched_setaffinity(0, {cpu}))
        if finished.returncode != 0:
            raise RunFailed(f"{' '.join(command)}\nfailed with exit code {finished.returncode}:\n"
                            f"{finished.stderr[-2000:]}")
        return stages_of(profile)


def count_all(program: pathlib.Path, names: list, frames: int) -> dict:
    cpus = queue.SimpleQueue()
    for cpu in sorted(os.sched_getaffinity(0)):
        cpus.put(cpu)

    def on_a_free_cpu(name):
        cpu = cpus.get()
        try:
            return count(program, name, frames, cpu)
        finally:
            cpus.put(cpu)

    with concurrent.futures.ThreadPoolExecutor(cpus.qsize()) as pool:
        return dict(zip(names, pool.map(on_a_free_cpu, names)))


def key_of(build: pathlib.Path) -> str:
    """Compiler of the build and the best vector instructions under valgrind: "gcc-12 avx2"."""
    found = list(build.glob("CMakeFiles/*/CMakeCXXCompiler.cmake"))
    text = found[0].read_text() if found else ""
    values = dict(re.findall(r'set\(CMAKE_CXX_COMPILER_(ID|VERSION) "([^"]*)"\)', text))
    names = {"GNU": "gcc", "Clang": "clang"}
    compiler = names.get(values.get("ID", ""), values.get("ID", "unknown"))
    flags = pathlib.Path("/proc/cpuinfo").read_text().split()
    vectors = next((name for name in ("avx2", "sse4_2") if name in flags), "other")
    return f"{compiler}-{values.get('VERSION', '0').split('.')[0]} {vectors}"


def print_table(counted: dict, recorded: dict) -> None:
    print("million instructions a frame (apart: once); in brackets: ratio to the recorded count")
    print(f"{'':14}" + "".join(f"{stage:>18}" for stage in (*STAGES, "apart")))
    for name, stages in counted.items():
        cells = []
        for stage, value in stages.items():
            before = recorded.get(name, {}).get(stage)
            cells.append(f"{value:9.2f} ({value / before:5.3f})" if before else f"{value:9.2f}        ")
        print(f"{name:14}" + "".join(f"{cell:>18}" for cell in cells))


def compare(counted: dict, recorded: dict, key: str) -> int:
    if not recorded:
        print(f"skipped: no counts are recorded for {key} ({COUNTS.name}); --record writes them")
        return SKIPPED
    more = [f"{name}, {stage}: {value:.2f} million instructions, recorded are {recorded[name][stage]:.2f}"
            for name, stages in counted.items() for stage, value in stages.items()
            if value > MOST * recorded.get(name, {}).get(stage, value)]
    for line in more:
        print(f"FAILED: {line}")
    print(f"{len(more)} stages need more than {MOST} times the recorded instructions")
    return 1 if more else 0


def missing() -> str:
    """What this machine lacks; empty when it has all."""
    if shutil.which("valgrind") is None:
        return "valgrind is not installed"
    data = pathlib.Path(os.environ.get("RTD_DATA_DIR", "/nonexistent"))
    clips = [clip for clip in sorted({clip for clip, _ in RUNS.values()}) if not (data / clip).is_dir()]
    return f"RTD_DATA_DIR has no {' and '.join(clips)}" if clips else ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=str(ROOT / "build/release"), help="build folder, of a release")
    parser.add_argument("--only", nargs="+", default=[""], help="runs whose names contain one of these words")
    parser.add_argument("--frames", type=int, default=FRAMES, help="of each clip; recorded are those of the default")
    parser.add_argument("--record", action="store_true", help="write the counts instead of comparing them")
    arguments = parser.parse_args()
    if lacks := missing():
        print(f"skipped: {lacks}")
        return SKIPPED
    build = pathlib.Path(arguments.build)
    names = [name for name in RUNS if any(word in name for word in arguments.only)]
    counts = json.loads(COUNTS.read_text()) if COUNTS.exists() else {}
    key = key_of(build)
    recorded = counts.get(key, {})
    try:
        counted = count_all(build / "bench/rtd_offline_run", names, arguments.frames)
    except RunFailed as failure:
        print(failure)
        return 2
    print_table(counted, recorded)
    if not arguments.record:
        return compare(counted, recorded, key)
    counts.setdefault(key, {}).update(counted)
    COUNTS.write_text(json.dumps(counts, indent=2) + "\n")
    print(f"recorded for {key}: {COUNTS}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
