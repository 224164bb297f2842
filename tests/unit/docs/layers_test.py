#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checks which folder includes which: no circle between the folders of common and services, and a service includes
another one only where docs/architecture.md says so."""
import collections
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
SUFFIXES = (".cpp", ".hpp", ".in")
INCLUDE = re.compile(r'^\s*#\s*include\s*"((?:common|services|tests)/[^"]+)"', re.MULTILINE)

# Who may include what of other services: both are beginnings of paths.
ACROSS_SERVICES = (
    ("services/evaluation/", "services/detector/core/"),  # runs the detector on images
    ("services/launcher/doctor/", "services/detector/core/"),  # tries the engines
    ("services/launcher/doctor/", "services/camera/openni2/openni2_device.hpp"),  # looks for cameras
    ("services/launcher/doctor/", "services/camera/realsense/realsense_device.hpp"),
    ("services/atlas/", "services/slam/core/"),  # joins maps of slam, by its place recognition and pose graph
    ("services/atlas/", "services/slam/map_file.hpp"),
    ("services/atlas/", "services/slam/slam_messages.hpp"),
    ("services/maps/", "services/slam/core/"),  # shows maps of slam
    ("services/maps/", "services/slam/map_file.hpp"),
)
MOST_ACROSS_SERVICES = 16
MOST_BOTH_WAYS = 2


def folder_of(path):
    """common/bus/fastdds/codec.cpp -> common/bus"""
    return "/".join(path.split("/")[:2])


def includes():
    """Pairs (file, included file) of common and services."""
    for top in ("common", "services"):
        for path in sorted((ROOT / top).rglob("*")):
            if path.suffix in SUFFIXES:
                name = path.relative_to(ROOT).as_posix()
                yield from ((name, found) for found in INCLUDE.findall(path.read_text(encoding="utf-8")))


def circle_in(pairs):
    """The folders of one circle, the first one again at the end, each with an include that makes it; or none."""
    edges = collections.defaultdict(dict)
    for source, target in pairs:
        if folder_of(source) != folder_of(target):
            edges[folder_of(source)].setdefault(folder_of(target), f"{source} includes {target}")
    done, path = set(), []

    def search(folder):
        if folder in path:
            circle = path[path.index(folder):] + [folder]
            return [edges[a][b] for a, b in zip(circle, circle[1:])]
        if folder in done:
            return []
        path.append(folder)
        for target in sorted(edges[folder]):
            if circle := search(target):
                return circle
        path.pop()
        done.add(folder)
        return []

    return next((circle for folder in sorted(edges) if (circle := search(folder))), [])


def across_services(pairs):
    return [(source, target) for source, target in pairs if source.startswith("services/")
            and target.startswith("services/") and folder_of(source) != folder_of(target)]


def is_allowed(source, target):
    return any(source.startswith(who) and target.startswith(what) for who, what in ACROSS_SERVICES)


def problems_in(pairs):
    circle = circle_in(pairs)
    problems = [f"a circle of folders: {'; '.join(circle)}"] if circle else []
    problems += [f"{source} includes {target}: what two services need belongs in common"
                 for source, target in across_services(pairs) if not is_allowed(source, target)]
    problems += [f"{source} includes {target}: common knows no service" for source, target in pairs
                 if source.startswith("common/") and target.startswith("services/")]
    problems += [f"{source} includes {target}: programs know no test" for source, target in pairs
                 if target.startswith("tests/")]
    return problems


class Layers(unittest.TestCase):
    PAIRS = list(includes())

    def test_folders_include_each_other_as_they_may(self):
        self.assertGreater(len(self.PAIRS), 1000)
        self.assertEqual(problems_in(self.PAIRS), [])

    def test_includes_across_services_do_not_grow(self):
        across = across_services(self.PAIRS)
        self.assertLessEqual(len(across), MOST_ACROSS_SERVICES, "\n" + "\n".join(map(" includes ".join, across)))

    def test_each_permission_is_used(self):
        for who, what in ACROSS_SERVICES:
            self.assertTrue(any(source.startswith(who) and target.startswith(what) for source, target in self.PAIRS),
                            f"{who} no longer includes {what}: remove the permission")

    def test_included_files_exist(self):
        self.assertEqual([f"{source}: no {target}" for source, target in self.PAIRS if not (ROOT / target).exists()], [])

    def test_few_sub_folders_include_each_other(self):
        pairs = {(str(pathlib.PurePath(source).parent), str(pathlib.PurePath(target).parent))
                 for source, target in self.PAIRS}
        both_ways = sorted({tuple(sorted(pair)) for pair in pairs if pair[0] != pair[1] and pair[::-1] in pairs})
        self.assertLessEqual(len(both_ways), MOST_BOTH_WAYS, both_ways)

    def test_the_architecture_names_each_folder(self):
        named = set(re.findall(r"[\w-]+", (ROOT / "docs/architecture.md").read_text(encoding="utf-8")))
        folders = {part for top in ("common", "services") for suffix in ("cpp", "js", "cmake")
                   for path in (ROOT / top).rglob(f"*.{suffix}") for part in path.relative_to(ROOT).parts[:-1]}
        self.assertGreater(len(folders), 60)
        self.assertEqual(sorted(folders - named), [])

    def test_a_circle_is_found(self):
        chain = [("common/a/x.cpp", "common/b/x.hpp"), ("common/b/y.hpp", "common/c/x.hpp")]
        self.assertEqual(circle_in(chain), [])
        circle = circle_in([*chain, ("common/c/z.cpp", "common/a/x.hpp")])
        self.assertEqual(len(circle), 3)
        self.assertIn("common/c/z.cpp includes common/a/x.hpp", circle)

    def test_a_wrong_include_is_found(self):
        for source, target in (("services/slam/a.cpp", "services/dense/core/voxel_map.hpp"),
                               ("services/evaluation/a.cpp", "services/launcher/run/run_setup.hpp"),
                               ("services/launcher/run/a.cpp", "services/detector/core/engine.hpp"),
                               ("common/io/a.cpp", "services/camera/main.hpp"),
                               ("services/slam/a.cpp", "tests/support/box_scene.hpp")):
            self.assertTrue(problems_in([(source, target)]), f"{source} includes {target}")
        self.assertEqual(problems_in([("services/evaluation/a.cpp", "services/detector/core/engine.hpp"),
                                      ("services/slam/a.cpp", "services/slam/b.hpp")]), [])


if __name__ == "__main__":
    unittest.main()
