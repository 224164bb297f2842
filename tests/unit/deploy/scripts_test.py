#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The scripts of deploy/: what they say of wrong arguments, and how long they say a build will take."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

DEPLOY = pathlib.Path(__file__).resolve().parents[3] / "deploy"


def run(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, **more)


class Scripts(unittest.TestCase):
    def test_help_names_the_systems(self):
        for script in ("try_on.sh", "cross.sh"):
            result = run(DEPLOY / script, "--help")
            self.assertEqual(result.returncode, 0, script)
            self.assertIn("bookworm|trixie", result.stdout)

    def test_another_system_is_refused(self):
        for script in ("try_on.sh", "cross.sh"):
            for arguments in ((), ("sid",), ("trixie:mips",)):
                result = run(DEPLOY / script, *arguments)
                self.assertEqual(result.returncode, 2, f"{script} {arguments}")
                self.assertIn("Usage:", result.stderr)

    def test_each_package_is_listed_once(self):
        every = run(DEPLOY / "setup.sh", "--list").stdout.split()
        product = run(DEPLOY / "setup.sh", "--product", "--list").stdout.split()
        minimum = run(DEPLOY / "setup.sh", "--minimum", "--list").stdout.split()
        self.assertEqual(len(every), len(set(every)))
        self.assertLess(set(minimum), set(product))
        self.assertLess(set(product), set(every))
        self.assertIn("libopenni2-dev", set(product) - set(minimum))

    @unittest.skipUnless(shutil.which("shellcheck"), "shellcheck is not installed")
    def test_shellcheck_finds_nothing(self):
        result = run("shellcheck", "-S", "warning", "-x", *sorted(map(str, DEPLOY.glob("*.sh"))), cwd=DEPLOY.parent)
        self.assertEqual(result.returncode, 0, result.stdout)


class Progress(unittest.TestCase):
    """show_progress() of environment.sh."""

    def shown(self, lines):
        script = f'root=/nonexistent; . "{DEPLOY}/environment.sh"; show_progress'
        return run("bash", "-c", script, "demo.sh", input="\n".join(lines) + "\n").stdout.splitlines()

    def test_what_the_compiler_says_is_passed_on_and_steps_are_not(self):
        shown = self.shown(["[1/90] Building a.o", "warning: unused", "[2/90] Building b.o", "ninja: no work to do."])
        self.assertEqual(shown, ["warning: unused", "ninja: no work to do."])

    def test_the_rest_is_estimated_by_the_pace_so_far(self):
        script = (f'root=/nonexistent; . "{DEPLOY}/environment.sh"; '
                  '{ sleep 16; echo "[32/96] Building a.o"; } | show_progress')
        shown = run("bash", "-c", script, "demo.sh").stdout
        found = re.search(r"^demo: 32 of 96 steps built, about (\d+) min (\d+) s to go$", shown, re.MULTILINE)
        self.assertTrue(found, shown)
        usual_s = 6 * 16 // int(run("nproc").stdout)  # of as many steps as are a sixth of all
        self.assertAlmostEqual(60 * int(found.group(1)) + int(found.group(2)), (usual_s + 16) * 64 / 48, delta=6)


if __name__ == "__main__":
    os.environ["LC_ALL"] = "C.UTF-8"
    unittest.main()
