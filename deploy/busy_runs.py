#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the pipeline in real time beside busy processes and prints coverage, error and latency of each run."""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog="Further options go to rtd run, e.g. -- --detector off")
    parser.add_argument("--bin", default="build/release/bin", type=pathlib.Path, help="folder of rtd (%(default)s)")
    parser.add_argument("--source", default=f"tum:{os.environ.get('RTD_DATA_DIR', '')}/walk_xyz", help="(%(default)s)")
    parser.add_argument("--busy", default=3, type=int, help="busy processes of ordinary priority (%(default)s)")
    parser.add_argument("--own-sessions", action="store_true",
                        help="each in a session of its own, to which Linux may give as much as to the whole pipeline")
    parser.add_argument("--runs", default=3, type=int, help="(%(default)s)")
    parser.add_argument("--domain", default=141, type=int, help="DDS domain (%(default)s)")
    parser.add_argument("options", nargs="*", metavar="-- OPTION", help="of rtd run")
    return parser.parse_args()


def run(args, out):
    command = [str(args.bin / "rtd"), "run", "--source", args.source, "--pace", "realtime", "--out", out, "--domain",
               str(args.domain), "--quiet", *args.options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"busy_runs: rtd run ended with exit code {done.returncode}: {done.stderr.strip() or done.stdout.strip()}")
    report = json.loads(pathlib.Path(out, "report.json").read_text(encoding="utf-8"))
    steps = pathlib.Path(out, "logs", "filter.log").read_text(encoding="utf-8").count("event=load_shed")
    latency, ate = report["latency_ms"], report.get("ate_rmse_m")
    print(f"coverage {report['coverage']:.3f}  ATE {'-' if ate is None else f'{ate:.4f} m'}  latency p50 "
          f"{latency['p50']:.0f} ms, p99 {latency['p99']:.0f} ms  load shed {steps} times", flush=True)


def main():
    args = arguments()
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"], start_new_session=args.own_sessions)
            for _ in range(args.busy)]
    try:
        for _ in range(args.runs):
            with tempfile.TemporaryDirectory(prefix="rtd_busy_") as out:
                run(args, out)
    finally:
        for process in busy:
            process.kill()


if __name__ == "__main__":
    main()
