#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checks count.py: what it reads from a profile, and which counts fail."""
import contextlib
import io
import pathlib
import tempfile
import unittest

import count

PROFILE = """fn=main
10 5
cfn=rtd::camera::PlayedSource::read_next()
calls=4 0
11 4000000
cfn=rtd::filter::OrbExtractor::extract(rtd::vision::RgbdImage const&, int, int)
calls=2 0
12 6000000
cfn=rtd::slam::SlamSystem::process(rtd::msg::FeatureFrame const&)
calls=2 0
13 10000000

fn=rtd::filter::OrbExtractor::extract(rtd::vision::RgbdImage const&, int, int)
cfn=rtd::filter::OrbExtractor::extract(rtd::vision::RgbdImage const&)
calls=2 0
14 5000000

fn=rtd::slam::MappingWorker::work()
cfn=rtd::slam::Mapper::insert(rtd::slam::KeyframeProposal const&)
calls=1 0
15 3000000
summary: 25000000
"""


def stages_of(text):
    with tempfile.TemporaryDirectory() as folder:
        profile = pathlib.Path(folder) / "profile"
        profile.write_text(text, encoding="utf-8")
        return count.stages_of(profile)


def quietly(function, *arguments):
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        return function(*arguments), printed.getvalue()


class Count(unittest.TestCase):
    def test_divides_a_profile_into_stages(self):
        self.assertEqual(stages_of(PROFILE), {"camera": 1.0, "orb": 3.0, "judge": 0.0, "tracking": 3.5, "mapping": 1.5,
                                              "all": 9.0, "apart": 5.0})

    def test_names_a_stage_whose_function_is_gone(self):
        with self.assertRaisesRegex(count.RunFailed, "Mapper::insert.*never called"):
            stages_of(PROFILE.replace("Mapper::insert", "Mapper::put"))

    def test_fails_for_a_tenth_more_than_recorded(self):
        recorded = {"clip": {"orb": 10.0, "judge": 0.0}}
        self.assertEqual(quietly(count.compare, {"clip": {"orb": 10.9, "judge": 0.0}}, recorded, "k")[0], 0)
        status, printed = quietly(count.compare, {"clip": {"orb": 11.1, "judge": 0.0}}, recorded, "k")
        self.assertEqual(status, 1)
        self.assertIn("FAILED: clip, orb: 11.10 million instructions, recorded are 10.00", printed)

    def test_skips_a_compiler_without_recorded_counts(self):
        status, printed = quietly(count.compare, {"clip": {"orb": 10.0}}, {}, "clang-19 avx2")
        self.assertEqual(status, count.SKIPPED)
        self.assertIn("skipped: no counts are recorded for clang-19 avx2", printed)

    def test_every_recorded_compiler_has_every_run(self):
        for runs in count.json.loads(count.COUNTS.read_text()).values():
            self.assertEqual(set(runs), set(count.RUNS))


if __name__ == "__main__":
    unittest.main()
