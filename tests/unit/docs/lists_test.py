#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that each list stands once in the code, and that the copies which people read agree with it.

The lists: filter modes, services, schemes of sources, names of metrics, how the forms of recordings begin and end, the
known networks, and the options that several processes take.
Tests are not searched: they write out what they expect.
"""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
MODES, SERVICES = "common/msg/filter_modes.hpp", "common/msg/services.hpp"
SCHEMES, MODELS = "common/camera/source_schemes.hpp", "common/service/model_locator.hpp"
METRICS, FORMS = "common/service/metric_names.hpp", "common/io/recording_forms.hpp"
OPTIONS = ("common/service/run_settings.hpp", "common/service/bus_config.hpp", "common/bus/bus_factory.hpp")
SOURCES = sorted(path.relative_to(ROOT).as_posix() for folder in ("common", "services")
                 for path in (ROOT / folder).rglob("*") if path.suffix in (".cpp", ".hpp", ".js", ".in"))

LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
METRIC_CALL = re.compile(r'\b(?:set_metric|find_metric|set_word|word_of|camera_counter)\((?:[^";{]*[,(] ?)?"([^"]*)"|'
                         r'\bmetric_on_this_host\("\w+", "([^"]*)"|^ +set\("([^"]*)"', re.MULTILINE)
SERVICES_IN_ROW = re.compile(r'"camera",\s*"detector",\s*"filter",\s*"slam"|camera, detector, filter, slam, dense')
DECLARED = re.compile(r'\.option\("([^"]+)"')
ADDED = re.compile(r'(?:\.option|add_(?:option|flag)\w*)\(\s*"([^"]+)"')
FORM = re.compile(r'#ROSBAG V|SQLite format 3|MCAP0|'
                  r'(?:extension\(\) [!=]= |ends_with\()"\.(?:mcap|bag|db3|zstd|zst)"|"\.(?:bag|db3)",\s*"\.')


def text_of(path):
    return (ROOT / path).read_text(encoding="utf-8")


def without_comments(text):
    return re.sub(r"(?m)(^|\s)//.*$", "", text)


def literals(text):
    """All string literals, as one text; adjacent ones are joined."""
    return "\n".join(LITERAL.findall(re.sub(r'"\s*\n\s*"', "", without_comments(text))))


def rows(path):
    """The first literal of each row of a table."""
    return re.findall(r'^ +\{(?:[\w:]+, |\.name = )?"([\w-]+)"', text_of(path), re.MULTILINE)


def writes_all(text, words):
    written = literals(text)
    return all(re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", written) for word in words)


def modes_without_common_words():
    return [mode for mode in rows(MODES) if mode not in ("off", "rtd")]


def lists_modes(text):
    return writes_all(text, modes_without_common_words())


def lists_schemes(text):
    """In one literal, or as literals in a row: a file may well treat one scheme after the other."""
    in_row = re.findall(r'(?:"[\w-]+",\s*){2,}"[\w-]+"', without_comments(text))
    return any(all(re.search(rf"(?<![\w-]){scheme}(?::(?!:)|\")", part) for scheme in ("bag", "db3", "mcap"))
               for part in [*literals(text).split("\n"), *in_row])


class Model:
    """A row of the table of networks."""

    def __init__(self, name, file, title, licence, usual):
        self.name, self.file, self.title, self.licence, self.usual = name, file, title, licence, usual == "true"


def models():
    row = re.compile(r'^ +\{"([^"]+)", "([^"]+)", "([^"]+)", "([^"]+)", (true|false)\}', re.MULTILINE)
    return [Model(*values) for values in row.findall(text_of(MODELS))]


def mask_model():
    return Model(*re.search(r'kMaskModel = \{"([^"]+)", "([^"]+)", "([^"]+)",\s+"([^"]+)", (true)\}',
                            text_of(MODELS)).groups())


def usual_files():
    return [model.file for model in models() if model.usual]


def lists_models(text):
    return any(writes_all(text, words) for words in ([model.name for model in models()], usual_files()))


def metric_literals(text):
    return ["".join(groups) for groups in METRIC_CALL.findall(without_comments(text))]


class Lists(unittest.TestCase):
    def assert_none_but(self, table, is_second_list):
        found = [path for path in SOURCES if path != table and is_second_list(text_of(path))]
        self.assertFalse(found, f"take it from {table}")

    def test_filter_modes_stand_once(self):
        self.assertGreaterEqual(len(rows(MODES)), 6)
        self.assertTrue(lists_modes(text_of(MODES)))
        self.assert_none_but(MODES, lists_modes)

    def test_options_of_a_run_are_declared_once(self):
        """Programs that mean something else by a word are left out: rtd-eval's --model, rtd-keystore's --robot, and
        rtd-atlas' --map, which is also written."""
        shared = [flags for path in OPTIONS for flags in DECLARED.findall(text_of(path))]
        self.assertIn("--camera-in-base", shared)
        self.assertEqual(len(shared), len(set(shared)))
        for path in SOURCES:
            if path in OPTIONS or path.startswith(("services/atlas/", "services/evaluation/",
                                                                  "services/keystore/")):
                continue
            again = set(shared) & set(ADDED.findall(text_of(path)))
            self.assertFalse(again, f"{path}: the setting has this option already")

    def test_schemes_of_sources_stand_once(self):
        self.assertGreaterEqual(len(rows(SCHEMES)), 8)
        self.assert_none_but(SCHEMES, lists_schemes)

    def test_models_stand_once(self):
        self.assertEqual(len(models()), len(rows(MODELS)))
        self.assertGreaterEqual(len(models()), 3)
        self.assertFalse([model.name for model in models() if model.usual and "GPL" in model.licence])
        self.assert_none_but(MODELS, lists_models)

    def test_services_stand_once(self):
        self.assertGreaterEqual(len(rows(SERVICES)), 9)
        self.assert_none_but(SERVICES, lambda text: SERVICES_IN_ROW.search(literals_in_row(text)))

    def test_forms_of_recordings_stand_once(self):
        self.assert_none_but(FORMS, lambda text: FORM.search(without_comments(text)))

    def test_metrics_are_set_and_read_by_their_constants(self):
        problems = {path: found for path in SOURCES if (found := metric_literals(text_of(path)))}
        self.assertFalse(problems, f"name them in {METRICS}")

    def test_each_metric_has_one_constant_that_is_used(self):
        constants = re.findall(r'constexpr char (\w+)\[\] = "([^"]+)"', text_of(METRICS))
        names = [name for _, name in constants]
        self.assertGreater(len(names), 60)
        self.assertEqual(sorted(set(names)), sorted(names))
        code = "\n".join(text_of(path) for path in SOURCES if path != METRICS)
        self.assertFalse([constant for constant, _ in constants if not re.search(rf"metric::{constant}\b", code)])

    def test_each_service_is_in_the_table_by_the_name_of_its_heartbeat(self):
        name_of = re.compile(r'constexpr const char\* kName = "(\w+)"')
        names = {name for path in SOURCES for name in name_of.findall(text_of(path))}
        self.assertEqual(sorted(names - {"detector_box"}), sorted(rows(SERVICES)))

    def test_copies_for_people_agree(self):
        modes = rows(MODES)
        for path, separator in (("config/rtd.yaml", ", "), ("services/filter/README.md", ", "),
                                ("services/launcher/README.md", "|"), ("docs/usage.md", ", ")):
            self.assertIn(separator.join(modes), text_of(path).replace("`", ""), path)
        camera = text_of("services/camera/README.md")
        self.assertFalse([scheme for scheme in rows(SCHEMES) if f"{scheme}:" not in camera])

    def test_copies_in_scripts_agree(self):
        in_texts = re.search(r"^SERVICES = \((.*)\)", text_of("tests/identity/check_texts.py"), re.MULTILINE).group(1)
        self.assertEqual(sorted(LITERAL.findall(in_texts)), sorted(rows(SERVICES)))

    def test_copies_of_the_models_agree(self):
        setup, fetch, install = (text_of(f"deploy/{name}.sh") for name in ("setup", "fetch_model", "install"))
        self.assertEqual(dict(re.findall(r"^ +([\w-]+)\) echo (\S+\.onnx) ;;", setup, re.MULTILINE)),
                         {model.name: model.file for model in models()})
        self.assertIn(f"'') echo {' '.join(usual_files())} ;;", setup)
        mask = mask_model()
        self.assertEqual(re.findall(r'"\$weights/([\w.-]+\.onnx)"', install), [*usual_files(), mask.file])
        self.assertIn(f"find_weights {mask.file}\n", setup)
        self.assertIn(f"fetch_model.sh\" {mask.name};", setup)
        *others, last = [model.name for model in models()]
        for text in (setup, fetch):
            self.assertIn(f"use {', '.join(others)} or {last}\"", text)
        self.assertIn(f'already "${{name:-{models()[0].name}}}"', fetch)
        choices = re.findall(r"^    ([\w-]+)\)\n", fetch, re.MULTILINE)
        self.assertEqual(choices, [model.name for model in [*models(), mask]])
        page = text_of("services/detector/README.md")
        for model in [*models(), mask]:
            choice = re.search(rf"^    {model.name}\)\n(.*?);;", fetch, re.MULTILINE | re.DOTALL).group(1)
            self.assertIn(f"model={model.file}\n", choice)
            self.assertRegex(choice, rf'title="{model.title} by \w+, {model.licence}[",]')
            self.assertIn(f"{model.name} ({model.licence}", setup)
            self.assertRegex(page, rf"(?m)^\| `{model.name}`.*\| `{model.file}`.*\|.*, {model.licence} \|$")

    def test_layouts_of_other_viewers_show_topics_that_exist(self):
        topics = {"/" + name for name in re.findall(r'"rt/([\w/]+)"', text_of("common/bus/topics.hpp"))}
        shown = set(re.findall(r'"(/[\w/]+)', text_of("config/foxglove_layout.json")))
        self.assertGreater(len(shown), 5)
        self.assertEqual(shown - topics, set())

    def test_a_second_list_would_be_found(self):
        self.assertTrue(lists_modes('const kModes = ["off", "semantic", "geometry", "epipolar", "rtd-paper", "rtd"];'))
        self.assertTrue(lists_modes('help = "off, semantic, geometry, "\n    "epipolar, rtd-paper or rtd";'))
        self.assertTrue(lists_schemes('"tum:FOLDER, bag:FILE, db3:FILE or mcap:FILE"'))
        self.assertTrue(lists_schemes('known = {"tum", "bag", "db3", "mcap"};'))
        self.assertTrue(lists_models('help = "yolox-nano, nanodet-g or yolov5-lite";'))
        self.assertTrue(lists_models('for (const char* file : {"yolox_nano.onnx", "nanodet_g.onnx"})'))
        in_row = literals_in_row('for (auto s : {"camera", "detector",\n "filter", "slam"})')
        self.assertTrue(SERVICES_IN_ROW.search(in_row))
        self.assertTrue(FORM.search('if (begin.starts_with("SQLite format 3"))'))
        self.assertTrue(FORM.search('path.extension() == ".bag"'))
        for call in ('heartbeat.set_metric("frames", 1);', 'find_metric(peer->status, "host_id")',
                     '    set("resends", 1);',
                     'heartbeat.set_metric(std::string("in:") + topic, 1);',
                     'heartbeat.metric_on_this_host("filter", "load_step");'):
            self.assertTrue(metric_literals(call), call)
        self.assertFalse(metric_literals("heartbeat.set_metric(service::metric::kFrames, 1);"))


def literals_in_row(text):
    return re.sub(r"\s+", " ", without_comments(text))


if __name__ == "__main__":
    unittest.main()
