#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the pipeline in real time beside busy processes, a browser or a client of the viewer and prints coverage, error
and latency.

An overload: --busy 6 --own-sessions --lose 0.5 --bursts 300
"""
import argparse
import asyncio
import contextlib
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

try:
    import websockets
except ImportError:
    websockets = None

PORT, DEBUG_PORT = 8797, 8798
PATIENCE_S = 60
SETTLED_S = 5  # a browser that has just started is still busy
BETWEEN_BURSTS_S = 2


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog="Further options go to rtd run, e.g. -- --detector off")
    parser.add_argument("--bin", default="build/release/bin", type=pathlib.Path, help="folder of rtd (%(default)s)")
    parser.add_argument("--source", default=f"tum:{os.environ.get('RTD_DATA_DIR', '')}/walk_xyz", help="(%(default)s)")
    parser.add_argument("--busy", default=3, type=int, help="busy processes of ordinary priority (%(default)s)")
    parser.add_argument("--own-sessions", action="store_true",
                        help="each in a session of its own, to which Linux may give as much as to the whole pipeline; as root "
                             "it does, in a control group")
    parser.add_argument("--lose", default=0, type=float, metavar="SHARE", help="of the frames, at random places")
    parser.add_argument("--bursts", default=0, type=float, metavar="MS",
                        help="stop all services for so long, again and again after two seconds")
    parser.add_argument("--browser", action="store_true",
                        help="with the viewer, and headless Chromium that shows its page, drawing in software; it waits for "
                             "the run")
    parser.add_argument("--client", action="store_true",
                        help="with the viewer and rtd-dense, and a client that receives what a page receives and draws "
                             "nothing, as a page on another computer")
    parser.add_argument("--compare", action="store_true", help="each run also without the browser or client, in turn")
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


async def receive_as_page():
    for _ in range(PATIENCE_S * 10):
        try:
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/live", subprotocols=["rtd.viewer.v1"], max_size=None,
                                          compression=None) as page:
                await page.send(json.dumps({"op": "options", "dense": True, "ready": True}))
                async for _ in page:
                    pass
            return  # the viewer has ended
        except websockets.exceptions.ConnectionClosed:
            return
        except OSError:
            await asyncio.sleep(0.1)


def without_some(source, share, folder):
    """The same source, of which a share of the frames is lost at random places."""
    if source.startswith("synthetic:"):
        return f"{source}{'&' if '?' in source else '?'}drops={share}"
    clip, thinned = pathlib.Path(source.removeprefix("tum:")).resolve(), pathlib.Path(folder, "thinned")
    thinned.mkdir()
    for entry in clip.iterdir():
        if entry.name != "associations.txt":
            (thinned / entry.name).symlink_to(entry)
    places = random.Random(1)
    pairs = (clip / "associations.txt").read_text(encoding="utf-8").splitlines(keepends=True)
    kept = [pair for pair in pairs if places.random() >= share]
    (thinned / "associations.txt").write_text("".join(kept), encoding="utf-8")
    return f"tum:{thinned}"


def own_control_group():
    """Of processor time; that of the whole host where groups have no such controller."""
    for line in pathlib.Path("/proc/self/cgroup").read_text(encoding="ascii").splitlines():
        _, controllers, group = line.split(":", 2)
        if "cpu" in controllers.split(","):
            return pathlib.Path("/sys/fs/cgroup", controllers, group.lstrip("/"))
    return pathlib.Path("/sys/fs/cgroup")


class SchedulingGroup:
    """Processes that together get as much processor time as any other group. Without rights for it: none."""

    def __init__(self, name):
        self.folder = own_control_group() / f"rtd_{os.getpid()}_{name}"
        try:
            self.folder.mkdir()
        except OSError:
            self.folder = None

    def add(self, process):
        if self.folder is not None:
            (self.folder / "cgroup.procs").write_text(str(process.pid), encoding="ascii")

    def close(self):
        if self.folder is not None:
            self.folder.rmdir()


@contextlib.contextmanager
def busy_processes(count, own_groups):
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"], start_new_session=own_groups)
            for _ in range(count)]
    groups = [SchedulingGroup(number) for number in range(count)] if own_groups else []
    for group, process in zip(groups, busy):
        group.add(process)
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()
        for group in groups:
            group.close()


def stop_again_and_again(process, burst_s, ended):
    """The launcher and its services, all at once; none is left stopped."""
    while not ended.wait(BETWEEN_BURSTS_S):
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
        with contextlib.suppress(OSError):
            everything = [process.pid, *map(int, children.read_text(encoding="ascii").split())]
            for number in (signal.SIGSTOP, signal.SIGCONT):
                for one in everything:
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(one, number)
                if number == signal.SIGSTOP:
                    time.sleep(burst_s)


def play(args, out, source, with_client):
    """The report of a run in real time."""
    command = [str(args.bin / "rtd"), "run", "--source", source, "--pace", "realtime", "--out", out, "--domain",
               str(args.domain), "--quiet", *args.options]
    if with_client:
        command += ["--viewer=exit", "--set", f"viewer.port={PORT}"]
    ended = threading.Event()
    group = SchedulingGroup("run") if args.own_sessions else None
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        if group is not None:
            group.add(process)
        bursts = threading.Thread(target=stop_again_and_again, args=(process, args.bursts / 1000, ended))
        if args.bursts > 0:
            bursts.start()
        if with_client:
            asyncio.run(receive_as_page())
        output, _ = process.communicate()
        ended.set()
        if args.bursts > 0:
            bursts.join()
    if group is not None:
        group.close()
    if process.returncode != 0:
        sys.exit(f"busy_runs: rtd run ended with exit code {process.returncode}: {output.strip()}")
    report = json.loads(pathlib.Path(out, "report.json").read_text(encoding="utf-8"))
    logs = "".join(pathlib.Path(out, "logs", f"{name}.log").read_text(encoding="utf-8") for name in ("filter", "slam"))
    report["events"] = {event: logs.count(f"event={event} ") for event in ("load_shed", "load_taken_back", "tracking_lost")}
    return report


def text_of(report):
    latency, ate, events = report["latency_ms"], report.get("ate_rmse_m"), report["events"]
    return (f"coverage {report['coverage']:.3f}, {report['frames_tracked']} poses of {report['frames_used']} frames that were "
            f"processed, lost {events['tracking_lost']} times  ATE {'-' if ate is None else f'{ate:.4f} m'}  latency p50 "
            f"{latency['p50']:.0f} ms, p99 {latency['p99']:.0f} ms  load shed {events['load_shed']} times, taken back "
            f"{events['load_taken_back']}")


def run(args, out, watched):
    source = without_some(args.source, args.lose, out) if args.lose > 0 else args.source
    with tempfile.TemporaryDirectory(prefix="rtd_chromium_", ignore_cleanup_errors=True) as profile:
        browser = Browser(args, profile) if watched and args.browser else None
        report = play(args, str(pathlib.Path(out, "run")), source, watched and args.client)
        if browser is not None:
            browser.close()
    print(f"{'watched  ' if watched else ''}{text_of(report)}", flush=True)


def main():
    args = arguments()
    if args.browser and shutil.which("chromium") is None:
        sys.exit("busy_runs: no chromium: run deploy/setup.sh --viewers")
    if args.client and websockets is None:
        sys.exit("busy_runs: no python3-websockets: run deploy/setup.sh")
    with busy_processes(args.busy, args.own_sessions):
        for _ in range(args.runs):
            for watched in [False, True] if args.compare else [args.browser or args.client]:
                with tempfile.TemporaryDirectory(prefix="rtd_busy_") as out:
                    run(args, out, watched)


if __name__ == "__main__":
    main()
