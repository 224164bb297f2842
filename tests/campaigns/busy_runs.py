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
import urllib.request

PORT, DEBUG_PORT = 8797, 8798
PATIENCE_S = 60
SETTLED_S = 5  # a browser that has just started is still busy


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog="Further options go to rtd run, e.g. -- --detector off")
    parser.add_argument("--bin", default="build/release/bin", type=pathlib.Path, help="folder of rtd (%(default)s)")
    parser.add_argument("--source", default=f"tum:{os.environ.get('RTD_DATA_DIR', '')}/walk_xyz", help="(%(default)s)")
    parser.add_argument("--busy", default=3, type=int, help="busy processes of ordinary priority (%(default)s)")
    parser.add_argument("--own-sessions", action="store_true",
                        help="each in a session of its own, to which Linux may give as much as to the whole pipeline")
    parser.add_argument("--browser", action="store_true",
                        help="with the viewer, and headless Chromium that shows its page, drawing in software; it waits for "
                             "the run")
    parser.add_argument("--compare", action="store_true", help="each run also without the browser, in turn")
    parser.add_argument("--runs", default=3, type=int, help="(%(default)s)")
    parser.add_argument("--domain", default=84, type=int, help="DDS domain (%(default)s)")
    parser.add_argument("options", nargs="*", metavar="-- OPTION", help="of rtd run")
    return parser.parse_args()


def page_waits():
    """Whether the page is connected to the viewer, by its title."""
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{DEBUG_PORT}/json", timeout=5) as answer:
            return any(page["title"].startswith("Waiting for a robot") for page in json.load(answer))
    except OSError:
        return False


class Browser:
    """A viewer of its own, and Chromium that shows its page and waits for a run."""

    def __init__(self, args, profile):
        self.viewer = subprocess.Popen([str(args.bin / "rtd"), "viewer", "--port", str(PORT), "--domain", str(args.domain)],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        until = time.monotonic() + PATIENCE_S
        self._wait(lambda: socket.socket().connect_ex(("127.0.0.1", PORT)) == 0, until, "the viewer does not listen")
        self.chromium = subprocess.Popen(
            ["chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--window-size=1280,800",
             "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", f"--remote-debugging-port={DEBUG_PORT}",
             f"--user-data-dir={profile}", f"http://127.0.0.1:{PORT}/"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._wait(page_waits, until, "the page does not connect")
        time.sleep(SETTLED_S)

    @staticmethod
    def _wait(condition, until, problem):
        while not condition():
            if time.monotonic() > until:
                sys.exit(f"busy_runs: {problem}")
            time.sleep(0.2)

    def close(self):
        for process in (self.chromium, self.viewer):
            process.terminate()
            process.wait()


def run(args, out, with_browser):
    command = [str(args.bin / "rtd"), "run", "--source", args.source, "--pace", "realtime", "--out", out, "--domain",
               str(args.domain), "--quiet", *args.options]
    with tempfile.TemporaryDirectory(prefix="rtd_chromium_", ignore_cleanup_errors=True) as profile:
        browser = Browser(args, profile) if with_browser else None
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            output, _ = process.communicate()
        if browser is not None:
            browser.close()
    if process.returncode != 0:
        sys.exit(f"busy_runs: rtd run ended with exit code {process.returncode}: {output.strip()}")
    report = json.loads(pathlib.Path(out, "report.json").read_text(encoding="utf-8"))
    steps = pathlib.Path(out, "logs", "filter.log").read_text(encoding="utf-8").count("event=load_shed")
    latency, ate = report["latency_ms"], report.get("ate_rmse_m")
    print(f"{'browser  ' if with_browser else ''}coverage {report['coverage']:.3f}  ATE {'-' if ate is None else f'{ate:.4f} m'}  latency p50 "
          f"{latency['p50']:.0f} ms, p99 {latency['p99']:.0f} ms  load shed {steps} times", flush=True)


def main():
    args = arguments()
    if (args.browser or args.compare) and shutil.which("chromium") is None:
        sys.exit("busy_runs: no chromium: run deploy/setup.sh --viewers")
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"], start_new_session=args.own_sessions)
            for _ in range(args.busy)]
    try:
        for _ in range(args.runs):
            for with_browser in [False, True] if args.compare else [args.browser]:
                with tempfile.TemporaryDirectory(prefix="rtd_busy_") as out:
                    run(args, out, with_browser)
    finally:
        for process in busy:
            process.kill()


if __name__ == "__main__":
    main()
