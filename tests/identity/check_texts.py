#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Shows that a change of the code has not changed what people and programs read: compares texts with recorded ones.

    tests/identity/check_texts.py [--bin build/release/bin] [--record]

Compared with tests/identity/golden: `--help` and `--print-config` of every executable, the keys of run.json, the
description of a recording (`rtd info --json`), and the metrics of the viewer. The messages of its page are compared by
a unit test. A difference is printed as diff(1) prints it. What many texts have in common is recorded once, in
golden/shared, and a line "@NAME" stands for it. `rtd X --help` has to equal `rtd-X --help`.

Exit codes: 0 all equal, 1 something differs.
"""
import argparse
import difflib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
GOLDEN = HERE / "golden"
COMMANDS = ("run", "demo", "doctor", "ablate", "benchmark", "eval", "report", "eval-detector", "convert", "info", "diff",
            "map", "export", "topics", "call", "keystore", "atlas", "link", "record", "replay", "viewer")
SERVICES = ("camera", "detector", "filter", "slam", "dense", "record", "replay", "link", "atlas", "viewer")
SHARED = {  # name: the text that has it, its first line, how its last line begins
    "options": ("help rtd-camera", "  -h,--help ", "  --print-config "),
    "bus_options": ("help rtd-camera", "Network:", "                              ROS_SECURITY_KEYSTORE"),
    "wide_bus_options": ("help rtd call", "Network:", "  --keystore "),
    "bus": ("config rtd-camera", "bus:", "    enclave: "),
    "small_bus": ("config rtd-slam", "bus:", "    enclave: "),
}


class Texts:
    """Runs the executables in an environment that is the same everywhere."""

    def __init__(self, folder: pathlib.Path, scratch: pathlib.Path):
        self.folder, self.scratch = folder, scratch
        self.environment = {"PATH": os.environ["PATH"], "HOME": str(scratch), "COLUMNS": "100", "LC_ALL": "C.UTF-8"}

    def output(self, *command: str, seconds: int = 60) -> str:
        finished = subprocess.run([str(self.folder / command[0]), *command[1:]], capture_output=True, text=True,
                                  timeout=seconds, env=self.environment, check=False)
        if finished.returncode != 0:
            sys.exit(f"{' '.join(command)}\nfailed with exit code {finished.returncode}:\n{finished.stderr}")
        return self.neutral(finished.stdout)

    def neutral(self, text: str) -> str:
        return text.replace(str(self.scratch), "SCRATCH").replace(str(self.folder), "BIN")

    def run(self) -> tuple:
        """The keys of run.json and the metrics of a viewer beside the run."""
        domain, port = str(62 + os.getpid() % 2), 20000 + os.getpid() % 10000
        out = self.scratch / "out"
        viewer = subprocess.Popen([str(self.folder / "rtd-viewer"), "--domain", domain, "--port", str(port)],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=self.environment)
        running = subprocess.Popen(
            [str(self.folder / "rtd"), "run", "--source", "synthetic:office?frames=90", "--detector", "off", "--quiet",
             "--out", str(out), "--domain", domain], stdout=subprocess.DEVNULL, env=self.environment)
        try:
            metrics = set()
            while running.poll() is None:
                metrics |= self.metrics(port)
                time.sleep(0.2)
        finally:
            viewer.terminate()
            viewer.wait(timeout=20)
        if running.returncode != 0:
            sys.exit(f"rtd run failed with exit code {running.returncode}")
        return "\n".join(sorted(keys_of(json.loads((out / "run.json").read_text())))) + "\n", "\n".join(sorted(metrics)) + "\n"

    @staticmethod
    def metrics(port: int) -> set:
        """Names with type, help and labels, without the values; what a busy host adds is left out, and so are images,
        which a viewer without a page reads now and then."""
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=2) as answer:
                lines = answer.read().decode().splitlines()
        except (urllib.error.URLError, OSError):
            return set()
        about, names = {}, set()
        for line in lines:
            if line.startswith("# "):  # HELP, then TYPE
                _, _, name, text = line.split(" ", 3)
                about[name] = f"{about.get(name, '')} {text}"
            else:
                labelled = re.sub(r'(host|pid|version|step)="[^"]*"', r'\1="..."', line.rsplit(" ", 1)[0])
                names.add(labelled + about[labelled.split("{")[0]])
        return {name for name in names if not re.search(r"dropped|lost|late|skipped|peer_|load|image_raw", name)}


def keys_of(value, path: str = "") -> set:
    """Each path with the type of what is there; the elements of an array are alike."""
    if isinstance(value, dict):
        return set().union(*(keys_of(part, f"{path}.{key}") for key, part in value.items())) or {f"{path} {{}}"}
    if isinstance(value, list):
        return set().union(*(keys_of(part, f"{path}[]") for part in value)) or {f"{path} []"}
    return {f"{path} {type(value).__name__.replace('int', 'number').replace('float', 'number')}"}


def collect(texts: Texts, with_help: bool) -> dict:
    found = {"help rtd": texts.output("rtd", "--help")}
    for command in COMMANDS:
        found[f"help rtd {command}"] = texts.output("rtd", command, "--help")
    for service in SERVICES:
        found[f"help rtd-{service}"] = text = texts.output(f"rtd-{service}", "--help")
        if found.pop(f"help rtd {service}", text) != text:
            sys.exit(f"rtd {service} --help and rtd-{service} --help differ")
    if not with_help:
        print(f"{len(found)} texts of --help are there and not compared: another CLI11 lays them out differently")
        found.clear()
    for service in SERVICES:
        found[f"config rtd-{service}"] = texts.output(f"rtd-{service}", "--print-config")
    recording = str(texts.scratch / "recording.mcap")
    texts.output("rtd", "convert", "synthetic:office", recording, "--frames", "3", "--compress", "none")
    found["info json"] = texts.output("rtd", "info", "--json", recording)
    found["run json keys"], found["metrics"] = texts.run()
    return found


def shared_blocks(found: dict) -> dict:
    blocks = {}
    for name, (text, first, last) in SHARED.items():
        lines = found[text].splitlines(True)
        begin = next(i for i, line in enumerate(lines) if line.startswith(first))
        end = next(i for i, line in enumerate(lines) if i >= begin and line.startswith(last))
        blocks[name] = "".join(lines[begin:end + 1])
    return blocks


def record(found: dict) -> None:
    (GOLDEN / "shared").mkdir(parents=True, exist_ok=True)
    blocks = shared_blocks(found)
    for name, text in found.items():
        for block, shared in blocks.items():
            text = ("\n" + text).replace("\n" + shared, f"\n@{block}\n")[1:]
        (GOLDEN / (name.replace(" ", "_") + ".txt")).write_text(text)
    for block, shared in blocks.items():
        (GOLDEN / "shared" / f"{block}.txt").write_text(shared)


def recorded_text(file: pathlib.Path) -> str:
    if not file.exists():
        return ""
    return re.sub(r"^@(\w+)\n", lambda found: (GOLDEN / "shared" / f"{found[1]}.txt").read_text(), file.read_text(),
                  flags=re.MULTILINE)


def compare(found: dict) -> int:
    different = 0
    for name, text in found.items():
        file = GOLDEN / (name.replace(" ", "_") + ".txt")
        recorded = recorded_text(file)
        if text == recorded:
            continue
        different += 1
        sys.stdout.writelines(difflib.unified_diff(recorded.splitlines(True), text.splitlines(True), file.name, "now", n=1))
    print(f"{len(found) - different} of {len(found)} texts are as recorded")
    return 1 if different else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=str(ROOT / "build/release/bin"), help="folder of the executables")
    parser.add_argument("--cli11", default="2.1", help="its version; the recorded texts of --help are of 2.1")
    parser.add_argument("--record", action="store_true", help="write the texts instead of comparing them")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="rtd_texts_") as scratch:
        found = collect(Texts(pathlib.Path(arguments.bin).resolve(), pathlib.Path(scratch)),
                        arguments.cli11.startswith("2.1"))
    if not arguments.record:
        return compare(found)
    record(found)
    print(f"recorded {len(found)} texts: {GOLDEN}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
