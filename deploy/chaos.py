#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Does harm to the services of a run, at random but repeatably, and prints how soon they are back.

Faults: kill (SIGKILL), stop (SIGSTOP for two seconds), shm (/dev/shm full for two seconds)."""
import argparse
import json
import os
import pathlib
import random
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time

SPAN_S = 2.0          # of a fault that lasts
WARM_UP_S = 8.0
LEAST_POSES = 0.95    # share of the frames outside of the faults' own spans
FAULT_SPAN_S = 3.0    # a fault and what it may cost


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", type=pathlib.Path, help="folder of rtd (%(default)s)")
    parser.add_argument("--source", default="synthetic:office?frames=0", help="endless (%(default)s)")
    parser.add_argument("--count", default=20, type=int, help="faults (%(default)s)")
    parser.add_argument("--pause", default=6.0, type=float, help="seconds between two faults (%(default)s)")
    parser.add_argument("--faults", default="kill,stop,shm", help="of these, comma-separated (%(default)s)")
    parser.add_argument("--services", default="filter,slam",
                        help="whom kill and stop meet (%(default)s); a run ends with its camera")
    parser.add_argument("--dds", default="fastdds", help="(%(default)s)")
    parser.add_argument("--domain", default=143, type=int, help="DDS domain (%(default)s)")
    parser.add_argument("--seed", default=1, type=int, help="(%(default)s)")
    parser.add_argument("options", nargs="*", metavar="-- OPTION", help="of rtd run")
    return parser.parse_args()


def pid_of(out, service):
    log = pathlib.Path(out, "logs", f"{service}.log").read_text(encoding="utf-8", errors="replace")
    return int(re.findall(r"event=started .*?pid=(\d+)", log)[-1])


def memory_mb(pids):
    total = 0
    for pid in pids:
        status = pathlib.Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
        total += int(re.search(r"VmRSS:\s+(\d+)", status)[1])
    return total / 1024


def fill_shared_memory():
    """Leaves a few pages, as a program with a leak would."""
    place = os.statvfs("/dev/shm")
    descriptor, path = tempfile.mkstemp(dir="/dev/shm", prefix="rtd_chaos_")
    try:
        os.posix_fallocate(descriptor, 0, max(place.f_bavail * place.f_frsize - 65536, 1))
        time.sleep(SPAN_S)
    finally:
        os.close(descriptor)
        os.unlink(path)


def harm(fault, pid):
    if fault == "kill":
        os.kill(pid, signal.SIGKILL)
    elif fault == "stop":
        os.kill(pid, signal.SIGSTOP)
        time.sleep(SPAN_S)
        os.kill(pid, signal.SIGCONT)
    else:
        fill_shared_memory()


def inflict(args, out, process):
    """The faults that were done: (fault, service, pid, time in ns)."""
    chance = random.Random(args.seed)
    done = []
    for number in range(args.count):
        if process.poll() is not None:
            sys.exit(f"chaos: rtd run ended after {number} faults with exit code {process.returncode}:\n{process.stdout.read()}")
        fault = chance.choice(args.faults.split(","))
        service = "-" if fault == "shm" else chance.choice(args.services.split(","))
        pid = None if service == "-" else pid_of(out, service)
        done.append((fault, service, pid, time.monotonic_ns()))
        print(f"chaos: {number + 1} of {args.count}: {fault} {service}", flush=True)
        harm(fault, pid)
        time.sleep(args.pause * chance.uniform(0.7, 1.3))
    return done


class Trace:
    """What `rtd run --trace` wrote: spans by process, poses in order."""

    def __init__(self, path):
        events = json.loads(path.read_text(encoding="utf-8"))["traceEvents"]
        self.names = {event["pid"]: event["args"]["name"] for event in events if event["ph"] == "M"}
        ways = [event for event in events if event["name"] == "camera to pose"]
        self.frames = sorted(event["ts"] * 1e3 for event in events if event["name"] == "publish"
                             and self.names[event["pid"]] == "rtd-camera")
        pairs = zip(ways[::2], ways[1::2])  # written together; frame numbers repeat once a camera has started again
        self.poses = sorted((begin["ts"] * 1e3, end["ts"] * 1e3) for begin, end in pairs)
        self.first = {}
        for event in events:
            if "ts" in event:
                self.first[event["pid"]] = min(self.first.get(event["pid"], float("inf")), event["ts"] * 1e3)

    def pose_after_s(self, at_ns):
        """Until the pose of a frame that was taken afterwards."""
        ends = [end for begin, end in self.poses if begin > at_ns]
        return (min(ends) - at_ns) * 1e-9 if ends else float("inf")

    def back_after_s(self, service, pid, at_ns):
        """Until another process of the service does something."""
        times = [at for one, at in self.first.items() if self.names[one] == f"rtd-{service}" and one != pid and at > at_ns]
        return (min(times) - at_ns) * 1e-9 if times else float("inf")

    def share_with_pose(self, faults):
        """Of the frames outside of the faults' spans."""
        spans = [(at - 1e8, at + FAULT_SPAN_S * 1e9) for _, _, _, at in faults]
        outside = [at for at in self.frames if not any(begin < at < end for begin, end in spans)]
        posed = {round(begin / 1e6) for begin, _ in self.poses}
        near = [at for at in outside if any(round(at / 1e6) + shift in posed for shift in range(-2, 12))]
        return len(near) / max(len(outside), 1)


def row(what, values):
    values = sorted(values)
    late = values[min(len(values) - 1, int(0.99 * len(values)))]
    print(f"{what:28} n {len(values):3}   median {statistics.median(values):6.2f} s   p99 {late:6.2f} s", flush=True)


def report(trace, faults, out):
    for fault, service in sorted({(fault, service) for fault, service, _, _ in faults}):
        those = [one for one in faults if one[:2] == (fault, service)]
        if fault == "kill":
            row(f"kill {service}: works again", [trace.back_after_s(service, pid, at) for _, _, pid, at in those])
        lasting_ns = 0 if fault == "kill" else SPAN_S * 1e9
        row(f"{fault} {service}: next pose", [trace.pose_after_s(at + lasting_ns) for _, _, _, at in those])
    share = trace.share_with_pose(faults)
    log = pathlib.Path(out, "logs", "slam.log").read_text(encoding="utf-8", errors="replace")
    print(f"frames with pose outside of the faults' spans {100 * share:.1f} %; maps begun {log.count('event=map_started')}, "
          f"loaded and found again {log.count('event=relocalized')}")
    return share >= LEAST_POSES


def main():
    args = arguments()
    with tempfile.TemporaryDirectory(prefix="rtd_chaos_") as folder:
        out, trace = folder + "/out", pathlib.Path(folder, "trace.json")
        command = [str(args.bin / "rtd"), "run", "--source", args.source, "--out", out, "--domain", str(args.domain), "--dds",
                   args.dds, "--detector", "off", "--quiet", "--trace", str(trace), "--set", "slam.map.checkpoint_s=5",
                   *args.options]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            try:
                time.sleep(WARM_UP_S)
                services = args.services.split(",")
                before_mb = memory_mb(pid_of(out, service) for service in services)
                faults = inflict(args, out, process)
                after_mb = memory_mb(pid_of(out, service) for service in services)
            finally:
                process.send_signal(signal.SIGINT)
                output, _ = process.communicate(timeout=60)
        print(f"memory of {', '.join(services)}: {before_mb:.0f} MB before, {after_mb:.0f} MB after")
        if not report(Trace(trace), faults, out):
            sys.exit(f"chaos: too few poses\n{output}")


if __name__ == "__main__":
    main()
