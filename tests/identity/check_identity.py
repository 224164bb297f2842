#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Shows that a change of the code has not changed its results: compares bytes with recorded hashes.

    tests/identity/check_identity.py [--bin build/release/bin] [--only NAME ...] [--as CLASS] [--record]

Compared are the trajectories and the map files of lockstep runs on six clips, the odometry of a robot's base, and the
MCAP files of two conversions. The wire bytes of every topic and the MCAP schemas are compared by unit tests, texts that
people and programs read by check_texts.py.
The detector's floating-point results depend on the vector instructions of the processor (OpenCV chooses them at run
time), and so do the trajectories: hashes are recorded per instruction set. Without recorded hashes for this processor,
or without clips and weights, those results are skipped, with a line that says so. --as CLASS compares as a lesser processor
would compute: the libraries are configured not to use the vector instructions beyond that class.

Exit codes: 0 all equal, 1 something differs, 77 nothing could be compared.
"""
import argparse
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
HASHES = HERE / "hashes.json"
CLIPS = ("fr1_xyz", "walk_xyz", "walk_rpy", "walk_box", "kinect_half", "kinect_rpy")
BASE_CLIP = "walk_xyz"  # of the robot's odometry
CLASSES = ("amx_tile", "avx512f", "avx2", "sse4_2")  # vector instructions, best first
MODEL = "v5lite-s-raw-480x640.onnx"
SKIPPED = 77


def instruction_set() -> str:
    """The best vector instructions of this processor that make a difference to OpenCV and the mathematics library."""
    flags = pathlib.Path("/proc/cpuinfo").read_text().split()
    return next((name for name in CLASSES if name in flags), "other")


def limits(instructions: str) -> dict:
    """Environment in which OpenCV, OpenBLAS and the mathematics library use nothing beyond these instructions."""
    no_avx512 = {"OPENCV_CPU_DISABLE": "AVX512-SKX,AVX512-COMMON,AVX512-CNL,AVX512-CLX,AVX512-ICL,AVX512-KNL,AVX512-KNM",
                 "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-AVX512CD",
                 "OPENBLAS_CORETYPE": "Haswell"}
    if instructions == "avx2":
        return no_avx512
    return {"OPENCV_CPU_DISABLE": no_avx512["OPENCV_CPU_DISABLE"] + ",AVX2,FMA3,AVX,FP16",
            "GLIBC_TUNABLES": no_avx512["GLIBC_TUNABLES"] + ",-AVX2_Usable,-AVX2,-FMA_Usable,-FMA,-AVX_Usable,-AVX",
            "OPENBLAS_CORETYPE": "Nehalem"}


def sha256(path: pathlib.Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def run(command: list, seconds: int) -> None:
    finished = subprocess.run(command, capture_output=True, text=True, timeout=seconds, check=False)
    if finished.returncode != 0:
        sys.exit(f"{' '.join(command)}\nfailed with exit code {finished.returncode}:\n{finished.stdout}{finished.stderr}")


def lockstep_run(rtd: str, data: pathlib.Path, clip: str, out: pathlib.Path) -> dict:
    """Runs the whole system, four processes, on one clip."""
    saved_map = out / "map.rtdmap"
    run([rtd, "run", "--source", f"tum:{data / clip}", "--pace", "lockstep", "--filter", "rtd", "--quiet",
         "--model", MODEL, "--engine", "cpu", "--out", str(out / "run"), "--save-map", str(saved_map),
         "--domain", str(64 + os.getpid() % 2)], 300)
    return {f"trajectory {clip}": sha256(out / "run" / "trajectory.txt"), f"map {clip}": sha256(saved_map)}


def base_odometry(rtd: str, data: pathlib.Path, out: pathlib.Path) -> str:
    """The odometry of a robot's base, as ROS 2 programs read it."""
    recording = str(out / "run.mcap")
    run([rtd, "run", "--source", f"tum:{data / BASE_CLIP}", "--frames", "60", "--pace", "lockstep", "--filter", "rtd",
         "--detector", "off", "--quiet", "--out", str(out / "run"), "--record", recording,
         "--camera-in-base=0.1,0,0.4,-0.5,0.5,-0.5,0.5", "--domain", str(64 + os.getpid() % 2)], 300)
    echoed = subprocess.run([rtd, "topics", "echo", "--verbose", recording, "/slam/odometry"],
                            capture_output=True, timeout=120, check=True)
    return hashlib.sha256(echoed.stdout).hexdigest()


def conversion(rtd: str, source: str, options: list, out: pathlib.Path) -> str:
    recording = out / "recording.mcap"
    run([rtd, "convert", source, str(recording), *options], 120)
    return sha256(recording)


def measure(rtd: str, wanted) -> dict:
    """{name: SHA-256} of all that can be made here; names that `wanted` refuses are left out."""
    data, models = (pathlib.Path(os.environ.get(name, "/nonexistent")) for name in ("RTD_DATA_DIR", "RTD_MODEL_DIR"))
    found = {}
    with tempfile.TemporaryDirectory(prefix="rtd_identity_") as folder:
        for clip in CLIPS:
            if not wanted(f"trajectory {clip}") and not wanted(f"map {clip}"):
                continue
            if not (data / clip).is_dir() or not (models / MODEL).is_file():
                print(f"skipped: {clip} (RTD_DATA_DIR needs the clip, RTD_MODEL_DIR {MODEL})")
                continue
            out = pathlib.Path(folder) / clip
            out.mkdir()
            found.update(lockstep_run(rtd, data, clip, out))
        if wanted("odometry base") and (data / BASE_CLIP).is_dir():
            out = pathlib.Path(folder) / "base"
            out.mkdir()
            found["odometry base"] = base_odometry(rtd, data, out)
        for name, source, options in (("mcap synthetic", "synthetic:office", ["--frames", "3", "--compress", "none"]),
                                      ("mcap fr1_desk_9", f"tum:{data / 'fr1_desk_9'}", ["--compress", "none"])):
            if not wanted(name):
                continue
            if source.startswith("tum:") and not pathlib.Path(source[4:]).is_dir():
                print(f"skipped: {name} (RTD_DATA_DIR needs the clip)")
                continue
            out = pathlib.Path(folder) / name.replace(" ", "_")
            out.mkdir()
            found[name] = conversion(rtd, source, options, out)
    return found


def compare(found: dict, recorded: dict, instructions: str) -> int:
    compared = different = 0
    for name, digest in found.items():
        if name not in recorded:
            print(f"skipped: {name} (no recorded hash for a processor with {instructions})")
            continue
        compared += 1
        different += digest != recorded[name]
        print(f"{'same' if digest == recorded[name] else 'DIFFERENT'}: {name} {digest[:16]}")
    print(f"{compared - different} of {compared} results have the recorded bytes")
    return 1 if different else 0 if compared else SKIPPED


def with_common_part(recorded: dict) -> dict:
    """What is the same on every processor is written once."""
    first = next(iter(recorded.values()))
    common = {name: digest for name, digest in first.items()
              if all(of_one.get(name) == digest for of_one in recorded.values())}
    return {"all": common, **{instructions: {name: digest for name, digest in of_one.items() if name not in common}
                              for instructions, of_one in recorded.items()}}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=str(ROOT / "build/release/bin"), help="folder of the executables")
    parser.add_argument("--only", nargs="+", default=[""], help="results whose names contain one of these words")
    parser.add_argument("--as", dest="instructions", choices=CLASSES[CLASSES.index("avx2"):],
                        help="compute as a processor with these instructions at best")
    parser.add_argument("--record", action="store_true", help="write the hashes instead of comparing them")
    arguments = parser.parse_args()
    instructions = arguments.instructions or instruction_set()
    if arguments.instructions:
        os.environ.update(limits(arguments.instructions))
    found = measure(str(pathlib.Path(arguments.bin) / "rtd"),
                    lambda name: any(word in name for word in arguments.only))
    hashes = json.loads(HASHES.read_text())
    recorded = {name: {**hashes["all"], **hashes[name]} for name in hashes if name != "all"}
    if not arguments.record:
        return compare(found, recorded.get(instructions, {}), instructions)
    recorded.setdefault(instructions, {}).update(found)
    HASHES.write_text(json.dumps(with_common_part(recorded), indent=2) + "\n")
    print(f"recorded {len(found)} hashes for a processor with {instructions}: {HASHES}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
