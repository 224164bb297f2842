# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever a program quotes, it prints as text that a terminal only shows. usage: test_printed_text.py FOLDER"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

FOLDER = pathlib.Path(sys.argv.pop())
PROGRAMS = sorted(path for path in FOLDER.glob("rtd*") if path.is_file())
SECTIONS = ["atlas", "bus", "camera", "dense", "detector", "filter", "link", "record", "replay", "slam", "viewer"]


def printed(text):
    """(what was run, stdout, stderr) of command lines and files that quote a text and are refused, for each program."""
    quoted = "".join(f"\\x{byte:02x}" for byte in text.encode())
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        file.writelines(f'{section}:\n  "{quoted}": 1\n' for section in SECTIONS)
        file.flush()
        lines = [[program.name, f"--{text}"] for program in PROGRAMS]
        lines += [["rtd-camera", *words, "--print-config"] for words in
                  (["--set", text], ["--set", f"bus.domain={text}"], ["--profile", text], ["--config", text],
                   ["--config", file.name], ["--dds", text], ["--pace", text], ["--log-level", text])]
        for uri in (text, f"folder:{text}"):
            lines += [["rtd-camera", "--preview", "--source", uri],
                      ["rtd-recording", "convert", uri, "/nonexistent/new"]]
        lines += [["rtd", text], ["rtd", "run", "--source", text], ["rtd", "run", "--set", f"{text}=1"],
                  ["rtd-eval", "trajectory", text, text], ["rtd-recording", "info", text], ["rtd-map", "info", text],
                  ["rtd-detector", "--image", text], ["rtd-topics", "echo", "--domain", text]]
        for program, *words in lines:
            if FOLDER / program in PROGRAMS:
                result = subprocess.run([FOLDER / program, *words], stdin=subprocess.DEVNULL, capture_output=True,
                                        timeout=60, check=False)
                yield [program, *(word[:20] for word in words)], result.stdout, result.stderr


class PrintedText(unittest.TestCase):
    def test_no_program_passes_on_control_characters(self):
        self.assertGreater(len(PROGRAMS), 3)
        for line, out, err in printed("\x1b[31mRED\x1b]0;owned\x07"):
            with self.subTest(line=line):
                self.assertNotRegex(out + err, rb"[\x1b\x07]")
                self.assertNotEqual(out + err, b"")

    def test_a_long_value_makes_no_long_message(self):
        for text in ("x" * 100_000, "a b=" * 25_000):
            for line, _, err in printed(text):
                with self.subTest(line=line):
                    self.assertLess(len(err), 2_200, err[:200])


if __name__ == "__main__":
    unittest.main()
