#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the pipeline in real time beside busy processes or a browser and prints coverage, error and latency."""
import argparse
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

PORT = 8797
PATIENCE_S = 30


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog="Further options go to rtd run, e.g. -- --detector off")
    parser.add_argument("--bin", default="build/release/bin", type=pathlib.Path, help="folder of rtd (%(default)s)")
    parser.add_argument("--source", default=f"tum:{os.environ.get('RTD_DATA_DIR', '')}/walk_xyz", help="(%(default)s)")
    parser.add_argument("--busy", default=3, type=int, help="busy processes of ordinary priority (%(default)s)")
    parser.add_argument("--own-sessions", action="store_true",
                        help="each in a session of its own, to which Linux may give as much as to the whole pipeline")
    parser.add_argument("--browser", action="store_true",
                        help="with the viewer, and headless Chromium that shows its page, drawing in software")
    parser.add_argument("--runs", default=3, type=int, help="(%(default)s)")
    parser.add_argument("--domain", default=141, type=int, help="DDS domain (%(default)s)")
    parser.add_argument("options", nargs="*", metavar="-- OPTION", help="of rtd run")
    return parser.parse_args()


def open_browser(profile):
    """Chromium on the viewer's page, once that is there."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", PORT)) == 0:
                break
        time.sleep(0.1)
    return subprocess.Popen(["chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--window-size=1280,800",
                             "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--remote-debugging-port=0",
                             f"--user-data-dir={profile}", f"http://127.0.0.1:{PORT}/"],
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def run(args, out):
    command = [str(args.bin / "rtd"), "run", "--source", args.source, "--pace", "realtime", "--out", out, "--domain",
               str(args.domain), "--quiet", *args.options]
    if args.browser:
        command += ["--viewer", "--set", f"viewer.port={PORT}"]
    with tempfile.TemporaryDirectory(prefix="rtd_chromium_", ignore_cleanup_errors=True) as profile, subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        browser = open_browser(profile) if args.browser else None
        output, _ = process.communicate()
        if browser is not None:
            browser.terminate()
            browser.wait()
    if process.returncode != 0:
        sys.exit(f"busy_runs: rtd run ended with exit code {process.returncode}: {output.strip()}")
    report = json.loads(pathlib.Path(out, "report.json").read_text(encoding="utf-8"))
    steps = pathlib.Path(out, "logs", "filter.log").read_text(encoding="utf-8").count("event=load_shed")
    latency, ate = report["latency_ms"], report.get("ate_rmse_m")
    print(f"coverage {report['coverage']:.3f}  ATE {'-' if ate is None else f'{ate:.4f} m'}  latency p50 "
          f"{latency['p50']:.0f} ms, p99 {latency['p99']:.0f} ms  load shed {steps} times", flush=True)


def main():
    args = arguments()
    if args.browser and shutil.which("chromium") is None:
        sys.exit("busy_runs: no chromium: run deploy/setup.sh --viewers")
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
