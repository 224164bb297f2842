#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Harms the services of a run, at random but repeatably, and prints how soon poses are back.

Faults: kill (SIGKILL), stop (SIGSTOP), shm (/dev/shm full), disk (the disk of the map full), clock (a step of up to an
hour), link (loopback down). All but kill and clock last two seconds. As root, everything happens in namespaces of this
program: neither the network nor the memory of the host is touched. Without root, disk and link are left out.

Next to much other work, with both vendors:
  for dds in fastdds cyclonedds; do for seed in 1 2 3; do chaos.py --minutes 4 --busy 3 --dds $dds --seed $seed; done; done
"""
import argparse
import contextlib
import json
import mmap
import os
import pathlib
import random
import re
import shutil
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import time

FAULTS = ("kill", "stop", "shm", "disk", "clock", "link")
NEED_ROOT = {"disk", "link"}
SERVICES = ("camera", "filter", "slam", "dense")
SPAN_S = 2.0          # of a fault that lasts
WARM_UP_S = 8.0       # until the first checkpoint is there
LEAST_POSES = 0.95    # share of the frames outside of the faults' own spans
FAULT_SPAN_S = 3.0    # a fault and what it may cost
UNWRITTEN_S = 1.1     # of the trace, when a process is killed
LARGEST_STEP_S = 3600
DISK_MB = 256
SHARED_MEMORY_MB = 1024


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", type=pathlib.Path, help="folder of rtd (%(default)s)")
    parser.add_argument("--source", default="synthetic:office?motion=tour&frames=0", help="endless (%(default)s)")
    parser.add_argument("--count", default=20, type=int, help="faults (%(default)s)")
    parser.add_argument("--minutes", default=0, type=float, help="instead of --count: faults until this time is over")
    parser.add_argument("--pause", default=6.0, type=float, help="seconds between two faults (%(default)s)")
    parser.add_argument("--faults", default=",".join(FAULTS), help="of these, comma-separated (%(default)s)")
    parser.add_argument("--services", default=",".join(SERVICES),
                        help="which ones are killed and stopped (%(default)s); detector needs its weights")
    parser.add_argument("--dds", default="fastdds", help="(%(default)s)")
    parser.add_argument("--domain", default=83, type=int, help="DDS domain (%(default)s)")
    parser.add_argument("--seed", default=1, type=int, help="(%(default)s)")
    parser.add_argument("--busy", default=0, type=int, help="busy processes beside it (%(default)s)")
    parser.add_argument("--own-sessions", action="store_true",
                        help="each in a session of its own, to which Linux gives as much as to the whole pipeline")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER", help="new, for logs and trace of the run")
    parser.add_argument("options", nargs="*", metavar="-- OPTION", help="of rtd run")
    args = parser.parse_args()
    args.faults, args.services = args.faults.split(","), args.services.split(",")
    if unknown := set(args.faults) - set(FAULTS):
        parser.error(f"--faults: unknown {', '.join(sorted(unknown))}; use {', '.join(FAULTS)}")
    if unknown := set(args.services) - {*SERVICES, "detector"}:
        parser.error(f"--services: unknown {', '.join(sorted(unknown))}; use {', '.join(SERVICES)}, detector")
    args.clock_library = args.bin.parent / "bench/librtd_clock_step.so"
    if "clock" in args.faults and not args.clock_library.exists():
        parser.error(f"--faults clock needs {args.clock_library}: build the target rtd_clock_step, or leave clock out")
    return args


def enter_namespaces(args):
    """Starts this program again with a network, a /dev/shm and mounts of its own."""
    if os.geteuid() != 0:
        args.faults = [fault for fault in args.faults if fault not in NEED_ROOT]
        print("chaos: not root: without the faults disk and link", flush=True)
    elif "RTD_IN_NAMESPACE" not in os.environ:
        os.environ["RTD_IN_NAMESPACE"] = "1"
        os.execvp("unshare", ["unshare", "-n", "-m", "--propagation", "private", sys.executable, "-B", *sys.argv])
    else:
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SHARED_MEMORY_MB}m", "tmpfs", "/dev/shm"], check=True)
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)


class Run:
    """An `rtd run` and what can be done to it."""

    def __init__(self, args, folder):
        self.args, self.out = args, folder + "/out"
        self.disk, self.step, self.trace = (pathlib.Path(folder, name) for name in ("disk", "step", "trace.json"))
        self.disk.mkdir()
        if os.geteuid() == 0:
            subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_MB}m", "tmpfs", str(self.disk)], check=True)
        self.step.write_bytes(bytes(8))
        command = [str(args.bin / "rtd"), "run", "--source", args.source, "--out", self.out, "--domain", str(args.domain),
                   "--dds", args.dds, "--quiet", "--trace", str(self.trace), "--save-map", str(self.disk / "room.rtdmap"),
                   "--set", "slam.map.checkpoint_s=5", *args.options]
        if "detector" not in args.services:
            command += ["--detector", "off"]
        if "dense" in args.services:
            command += ["--dense"]
        environment = dict(os.environ)
        if "clock" in args.faults:
            environment |= {"LD_PRELOAD": str(args.clock_library.resolve()), "RTD_CLOCK_STEP_FILE": str(self.step)}
        self.output = pathlib.Path(folder, "output")
        with self.output.open("w", encoding="utf-8") as output:
            self.process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, env=environment)

    def printed(self):
        return self.output.read_text(encoding="utf-8", errors="replace")

    def log(self, service):
        return pathlib.Path(self.out, "logs", f"{service}.log").read_text(encoding="utf-8", errors="replace")

    def pid_of(self, service):
        return int(re.findall(r"event=started .*?pid=(\d+)", self.log(service))[-1])

    def memory_mb(self):
        """Of each service, without pages of shared memory and files."""
        sizes = {}
        for service in self.args.services:
            status = pathlib.Path(f"/proc/{self.pid_of(service)}/status").read_text(encoding="utf-8")
            sizes[service] = int(re.search(r"RssAnon:\s+(\d+)", status)[1]) / 1024
        return sizes

    def harm(self, fault, pid, chance):
        if fault == "kill":
            os.kill(pid, signal.SIGKILL)
        elif fault == "stop":
            os.kill(pid, signal.SIGSTOP)
            time.sleep(SPAN_S)
            os.kill(pid, signal.SIGCONT)
        elif fault == "clock":
            with self.step.open("r+b") as file, mmap.mmap(file.fileno(), 8) as offset:
                offset[:8] = struct.pack("<q", int(chance.uniform(-LARGEST_STEP_S, LARGEST_STEP_S) * 1e9))
        elif fault == "link":
            subprocess.run(["ip", "link", "set", "lo", "down"], check=True)
            time.sleep(SPAN_S)
            subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        else:
            fill("/dev/shm" if fault == "shm" else self.disk)

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(timeout=120)
        return self.printed()


def fill(folder):
    """Takes all room for SPAN_S, as a program with a leak would."""
    with tempfile.NamedTemporaryFile(dir=folder, prefix="rtd_chaos_", buffering=0) as file:
        try:
            while True:  # others may take or free some meanwhile
                file.write(bytes(1 << 20))
        except OSError:
            time.sleep(SPAN_S)


def show_memory(run, when):
    sizes = run.memory_mb()
    print(f"chaos: {when}: " + ", ".join(f"{name} {size:.0f} MB" for name, size in sizes.items()), flush=True)


def inflict(args, run):
    """The faults that were done: (fault, service, pid, time in ns)."""
    chance = random.Random(args.seed)
    started, shown, done, turn = time.monotonic(), time.monotonic(), [], 0
    while len(done) < args.count if args.minutes == 0 else time.monotonic() - started < 60 * args.minutes:
        if run.process.poll() is not None:
            sys.exit(f"chaos: rtd run ended after {len(done)} faults with exit code {run.process.returncode}:\n"
                     f"{run.printed()}")
        fault = chance.choice(args.faults)
        service = ""
        if fault in ("kill", "stop"):  # in turn: one that was killed twice within 5 s is restarted later
            service = args.services[turn % len(args.services)]
            turn += 1
        pid = run.pid_of(service) if service else None
        if service and not pathlib.Path(f"/proc/{pid}").exists():  # killed, and not back yet
            time.sleep(0.5)
            continue
        done.append((fault, service, pid, time.monotonic_ns()))
        print(f"chaos: {(time.monotonic() - started) / 60:.1f} min: {fault} {service}", flush=True)
        run.harm(fault, pid, chance)
        time.sleep(args.pause * chance.uniform(0.7, 1.3))
        if time.monotonic() - shown > 600:
            show_memory(run, f"{(time.monotonic() - started) / 60:.0f} min")
            shown = time.monotonic()
    return done


class Trace:
    """What `rtd run --trace` wrote, one event a line: beginnings of processes, frames sent, poses."""

    def __init__(self, path):
        self.first, self.begun, self.joined, self.frames, self.poses, names, begun = {}, {}, {}, [], [], {}, {}
        with path.open(encoding="utf-8") as lines:
            events = (json.loads(line.strip(",\n")) for line in lines if '"ph"' in line)
            for event in events:
                pid, at_ns = event["pid"], event.get("ts", 0) * 1e3
                if event["ph"] == "M":
                    names[pid] = event["args"]["name"]
                    continue
                if event["name"] == "join":
                    self.begun[pid] = at_ns
                    self.joined[pid] = at_ns + event["dur"] * 1e3
                    continue
                self.first[pid] = min(self.first.get(pid, float("inf")), at_ns)
                if event["name"] == "publish" and names[pid] == "rtd-camera":
                    self.frames.append(at_ns)
                elif event["name"] == "camera to pose" and event["ph"] == "b":
                    begun[pid] = at_ns
                elif event["name"] == "camera to pose":
                    self.poses.append((begun[pid], at_ns))  # both are written together
        self.names = names
        self.frames.sort()
        self.poses.sort()

    def pose_after_s(self, at_ns):
        """Until the pose of a frame that was taken afterwards."""
        ends = [end for begin, end in self.poses if begin > at_ns]
        return (min(ends) - at_ns) * 1e-9 if ends else float("inf")

    def back_after_s(self, service, pid, at_ns):
        """Until another process of the service works on a frame; has joined the bus, where keyframes are rare work."""
        return self._next_s(self.joined if service == "dense" else self.first, service, pid, at_ns)

    def steps_s(self, service, pid, at_ns):
        """Until another process of the service begins to join the bus, and has joined it."""
        return [self._next_s(times, service, pid, at_ns) for times in (self.begun, self.joined)]

    def _next_s(self, of_pid, service, pid, at_ns):
        times = [at for one, at in of_pid.items() if self.names[one] == f"rtd-{service}" and one != pid and at > at_ns]
        return (min(times) - at_ns) * 1e-9 if times else float("inf")

    def share_with_pose(self, faults):
        """Of the frames outside of the faults' spans."""
        spans = [(at - UNWRITTEN_S * 1e9, at + FAULT_SPAN_S * 1e9) for _, _, _, at in faults]
        outside = [at for at in self.frames if not any(begin < at < end for begin, end in spans)]
        posed = {round(begin / 1e6) for begin, _ in self.poses}
        near = [at for at in outside if any(round(at / 1e6) + shift in posed for shift in range(-2, 12))]
        return len(near) / max(len(outside), 1)


def row(what, values):
    values = sorted(values)
    late = values[min(len(values) - 1, int(0.99 * len(values)))]
    print(f"{what:28} n {len(values):3}   median {statistics.median(values):6.2f} s   p99 {late:6.2f} s", flush=True)


def report(run, trace, faults):
    """Prints the figures; true when they are good enough."""
    for fault, service in sorted({(fault, service) for fault, service, _, _ in faults}):
        those = [one for one in faults if one[:2] == (fault, service)]
        name = f"{fault} {service}".strip()
        if fault == "kill":
            for step, values in zip(("starts", "has joined"), zip(*(trace.steps_s(service, pid, at) for _, _, pid, at in those))):
                row(f"{name}: {step}", values)
            row(f"{name}: works again", [trace.back_after_s(service, pid, at) for _, _, pid, at in those])
        lasting_ns = 0 if fault in ("kill", "clock") else SPAN_S * 1e9
        row(f"{name}: next pose", [trace.pose_after_s(at + lasting_ns) for _, _, _, at in those])
    share, log = trace.share_with_pose(faults), run.log("slam")
    maps = log.count("event=map_started")
    print(f"frames with pose outside of the faults' spans {100 * share:.1f} %; maps begun {maps}, "
          f"loaded and found again {log.count('event=relocalized')}")
    return share >= LEAST_POSES and maps == 1


@contextlib.contextmanager
def busy(count, own_sessions):
    spinning = [subprocess.Popen([sys.executable, "-c", "while True: pass"], start_new_session=own_sessions)
                for _ in range(count)]
    try:
        yield
    finally:
        for process in spinning:
            process.kill()
            process.wait()


def main():
    args = arguments()
    enter_namespaces(args)
    with tempfile.TemporaryDirectory(prefix="rtd_chaos_") as folder, busy(args.busy, args.own_sessions):
        run = Run(args, folder)
        try:
            time.sleep(WARM_UP_S)
            show_memory(run, "before")
            faults = inflict(args, run)
            show_memory(run, "after")
        finally:
            output = run.stop()
            if os.geteuid() == 0:
                subprocess.run(["umount", "-l", str(run.disk)], check=True)
            if args.keep:
                shutil.copytree(run.out, args.keep)
                shutil.copy(run.trace, args.keep)
                shutil.copy(run.output, args.keep)
        if not report(run, Trace(run.trace), faults):
            sys.exit(f"chaos: too few poses, or a map was lost\n{output}")


if __name__ == "__main__":
    main()
