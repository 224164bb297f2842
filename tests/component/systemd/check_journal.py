#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""check_journal.py RTD_SLAM: under a journal (a stand-in for its socket, in a mount namespace of this test) a service
sends its log lines there with their fields, and prints nothing. Exit code 77 = skipped."""
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time

FOLDER = pathlib.Path("/run/systemd/journal")
PATIENCE_S = 20


def enter_namespace():
    if os.geteuid() != 0:
        print("SKIPPED: needs root for a mount namespace")
        sys.exit(77)
    if "RTD_IN_NAMESPACE" not in os.environ:
        if subprocess.run(["unshare", "-m", "true"], check=False).returncode != 0:
            print("SKIPPED: this kernel gives no mount namespace here")
            sys.exit(77)
        os.environ["RTD_IN_NAMESPACE"] = "1"
        os.execvp("unshare", ["unshare", "-m", "--propagation", "private", sys.executable, "-B", *sys.argv])
    subprocess.run(["mount", "-t", "tmpfs", "tmpfs", "/run"], check=True)
    FOLDER.mkdir(parents=True)


def lines_of(journal, until):
    journal.settimeout(1)
    end = time.monotonic() + PATIENCE_S
    got = []
    while time.monotonic() < end:
        try:
            got.append(journal.recv(65536).decode(errors="replace").splitlines())
        except TimeoutError:
            continue
        if any(until in line for line in got):
            return got
    sys.exit(f"FAILED: no {until} in the journal within {PATIENCE_S} s: {got}")


def main():
    enter_namespace()
    journal = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    journal.bind(str(FOLDER / "socket"))
    with tempfile.TemporaryFile() as stderr:
        status = os.fstat(stderr.fileno())
        service = subprocess.Popen([sys.argv[1], "--domain", "80"], stderr=stderr,
                                   env={**os.environ, "JOURNAL_STREAM": f"{status.st_dev}:{status.st_ino}"})
        try:
            got = lines_of(journal, "RTD_EVENT=started")
        finally:
            service.send_signal(signal.SIGTERM)
            service.wait(PATIENCE_S)
        started = next(line for line in got if "RTD_EVENT=started" in line)
        for field in ("SYSLOG_IDENTIFIER=rtd-slam", "PRIORITY=6", "RTD_DOMAIN=80", f"RTD_PID={service.pid}"):
            if field not in started:
                sys.exit(f"FAILED: no {field} in {started}")
        stderr.seek(0)
        if printed := stderr.read():
            sys.exit(f"FAILED: also printed: {printed}")
    print("the journal got the lines with their fields")


main()
