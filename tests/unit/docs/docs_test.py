#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the documentation matches the repository: links, paths, names, version, line length, words."""
import os
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
SKIPPED_FOLDERS = {".git", "build", "rtd-demo", "shared", "node_modules", "__pycache__"}
TOP_FOLDERS = ("common", "config", "deploy", "docs", "idl", "services", "tests")
SOURCE_SUFFIXES = (".cpp", ".hpp", ".c", ".h", ".py", ".sh", ".mjs", ".cmake", ".idl", ".md", ".supp")
MAX_LINE = 120
OUTPUT_AND_EXTERNAL_FILES = {"ablation.md", "associate.py"}
LONGEST_RESULTS, LONGEST_CHANGES = 250, 60  # lines of the page, and of each version's section
# colcon reads package.xml before CMake runs, so this copy has to be a literal; the test compares it.
ROS_PACKAGES = {"idl/ros2/rtd_msgs/package.xml", "deploy/ros2/rtd_slam_launch/package.xml"}
VERSION_COPIES = {"CMakeLists.txt", "CHANGELOG.md", *ROS_PACKAGES}

PATH_IN_COMMENT = re.compile(rf"(?<![\w/.-])(?:{'|'.join(TOP_FOLDERS)})/[\w./-]*\w")

# Words that a native engineer would not write; left: pattern, right: what to write instead.
WORDS = {
    r"\bother people's\b": "other, external",
    r"\bDESIGN(\.md| section)\b": "no reference to documents outside the project",
    r"\bWhat comes later\b": "describe what exists",
    r"\b\d\. time\b": "third time",
}


# The same for names: single words of comments, texts and identifiers (heard_ns, kHeardNs), in prose and in sources.
PLAIN_WORDS = {
    "anew": "again",
    "nobody": "no process, none, unknown", "anybody": "any program", "somebody": "a person, a program",
    "everybody": "all, every process",
    "foreign": "of another camera, program, ...",
    "hear": "receive", "hears": "receives", "heard": "received", "overheard": "received", "deaf": "receives nothing",
    "tell": "report, distinguish", "tells": "reports, distinguishes", "told": "reported, given",
    "wish": "request, option", "wishes": "requests, options", "twins": "second instance",
    "goes on": "continues", "bears": "has, survives",
}
CODE_SUFFIXES = (".cpp", ".hpp", ".c", ".h", ".py", ".sh", ".js", ".mjs", ".cjs", ".cmake", ".idl")
GOLDEN = re.compile(r"(^|/)golden(/|[^/]*$)")
# What an interface outside of this project, or a former name that is still read, calls so.
WORD_EXCEPTIONS = (
    r"\bUser=nobody\b", r"user `nobody`",    # Unix's user
    r"\{\"told\", \"level\"\}", r"[!=]= \"told\"", r"`told`: former name",  # --gravity told
)


def words_of(line):
    """Also the parts of identifiers: frames_heard, kHeardNs, and two words that follow each other, goes_on."""
    parts = [part.lower() for part in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", line)]
    return set(parts) | {" ".join(pair) for pair in zip(parts, parts[1:])}


def repository_files():
    for folder, subfolders, names in os.walk(ROOT):
        subfolders[:] = [name for name in subfolders if name not in SKIPPED_FOLDERS]
        for name in names:
            yield (pathlib.Path(folder) / name).relative_to(ROOT)


FILES = sorted(repository_files())
PAGES = [path for path in FILES if path.suffix == ".md"]
NAMES = {path.name for path in FILES}


def text_of(path):
    return (ROOT / path).read_text(encoding="utf-8")


def without_code_blocks(text):
    """Same number of lines; fenced blocks and indented formulas are emptied."""
    lines, fenced = [], False
    for line in text.split("\n"):
        fence = line.startswith("```")
        lines.append("" if fenced or fence or line.startswith("    ") or line.startswith("$$") else line)
        fenced ^= fence
    return lines


def inline_code(path):
    for number, line in enumerate(without_code_blocks(text_of(path)), 1):
        for code in re.findall(r"`([^`]+)`", line):
            yield number, code


def anchors(path):
    """Anchors of the headings, formed as GitHub forms them."""
    found = set()
    for line in without_code_blocks(text_of(path)):
        if heading := re.match(r"#+ (.*)", line):
            plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).lower()
            found.add(re.sub(r"[^\w\- ]", "", plain).replace(" ", "-"))
    return found


class Docs(unittest.TestCase):
    def assert_none(self, problems):
        self.assertFalse(problems, "\n" + "\n".join(problems))

    def test_relative_links_resolve(self):
        problems = []
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", "\n".join(without_code_blocks(text_of(page)))):
                if re.match(r"[a-z]+:", target):
                    continue
                name, _, anchor = target.partition("#")
                linked = (ROOT / page.parent / name).resolve() if name else ROOT / page
                if not linked.exists():
                    problems.append(f"{page}: {target} does not exist")
                elif anchor and anchor not in anchors(linked.relative_to(ROOT)):
                    problems.append(f"{page}: {target}: no such heading")
        self.assert_none(problems)

    def test_named_paths_exist(self):
        problems = []
        for page in PAGES:
            for number, code in inline_code(page):
                path = re.fullmatch(rf"(?:{'|'.join(TOP_FOLDERS)})/[\w./*+-]*", code)
                if path and not any(ROOT.glob(code.rstrip("/"))) and not any(ROOT.glob(code + ".*")):
                    problems.append(f"{page}:{number}: {code} does not exist")
        self.assert_none(problems)

    def test_paths_in_comments_exist(self):
        problems, paths = [], [str(path) for path in FILES]
        for path in FILES:
            if path.suffix not in (".cpp", ".hpp", ".py", ".sh", ".cmake", ".txt") or path.name == "docs_test.py":
                continue
            for number, line in enumerate(text_of(path).split("\n"), 1):
                comment = re.search(r"(?://|#(?!include)).*", line)
                for code in PATH_IN_COMMENT.findall(comment.group() if comment else ""):
                    if not any(name.startswith(code) for name in paths):
                        problems.append(f"{path}:{number}: {code} does not exist")
        self.assert_none(problems)

    def test_named_source_files_exist(self):
        problems = []
        for page in PAGES:
            for number, code in inline_code(page):
                if re.fullmatch(r"[\w./-]+", code) and code.endswith(SOURCE_SUFFIXES) \
                        and pathlib.PurePath(code).name not in NAMES | OUTPUT_AND_EXTERNAL_FILES:
                    problems.append(f"{page}:{number}: no file {code} in the repository")
        self.assert_none(problems)

    def test_files_in_tables_of_contents_exist(self):
        """Tables that start with `| file |` or `| folder |` name files or folders beside the README."""
        problems = []
        for page in PAGES:
            names = {part for path in FILES if path.parent.is_relative_to(page.parent)
                     for part in (path.stem, *path.relative_to(page.parent).parts)}
            inside = False
            for number, line in enumerate(text_of(page).split("\n"), 1):
                inside = line.startswith("|") and (inside or bool(re.match(r"\| (file|folder|header)s? \|", line)))
                for code in re.findall(r"`([\w./]+)`", line.split("|")[1]) if inside else []:
                    known = names | ({path.stem for path in FILES} if code.startswith(TOP_FOLDERS) else set())
                    if not all(part in known for part in code.strip("/").split("/")[-1:]):
                        problems.append(f"{page}:{number}: {code} does not exist")
        self.assert_none(problems)

    def test_named_tests_exist(self):
        """A name such as test_bus_${test} in a loop stands for every word of the lists of tests."""
        lists = "\n".join(text_of(path) for path in FILES if path.name == "CMakeLists.txt" and path.parts[0] == "tests")
        words = set(re.findall(r"\w+", lists))
        in_loops = re.findall(r"\b(?:test|fuzz)_[\w${}]*\$[\w{}]+", lists)
        loops = {re.sub(r"\$\{\w+\}", r"(\\w+)", name) for name in in_loops}

        def known(name):
            matches = (re.fullmatch(loop, name) for loop in loops)
            return name in words or any(match and set(match.groups()) <= words for match in matches)

        self.assert_none([f"{page}:{number}: no test {name}" for page in PAGES for number, code in inline_code(page)
                          for name in re.findall(r"(?<![\w.])(?:test|fuzz)_\w+", code) if not known(name)])

    def test_named_log_events_exist(self):
        sources = "\n".join(text_of(path) for path in FILES
                            if path.parts[0] in ("services", "common") and path.suffix in (".cpp", ".hpp"))
        known = set(re.findall(r"event=(\w+)", sources))
        self.assert_none([f"{page}: the log has no event={event}" for page in PAGES
                          for event in re.findall(r"event=(\w+)", text_of(page)) if event not in known])

    def test_lines_are_short(self):
        self.assert_none([f"{page}:{number}: {len(line)} characters" for page in PAGES
                          for number, line in enumerate(without_code_blocks(text_of(page)), 1)
                          if len(line) > MAX_LINE and not line.startswith("|") and "://" not in line])

    def test_results_and_changes_are_short(self):
        """Details and history belong in docs/lab; the changelog says what users can do."""
        self.assertLessEqual(text_of("docs/results.md").count("\n"), LONGEST_RESULTS)
        for section in re.split(r"^## ", text_of("CHANGELOG.md"), flags=re.MULTILINE):
            self.assertLessEqual(section.count("\n"), LONGEST_CHANGES, section.split("\n")[0])

    def test_version_stands_in_one_place(self):
        version = re.search(r"^project\(\w+ VERSION ([\d.]+)", text_of("CMakeLists.txt"), re.MULTILINE).group(1)
        for package in ROS_PACKAGES:
            self.assertIn(f"<version>{version}</version>", text_of(package))
        self.assertRegex(text_of("CHANGELOG.md"), rf"(?m)^## {re.escape(version)} - \d{{4}}-\d\d-\d\d$")
        copy = re.compile(rf"(?<![\d.]){re.escape(version)}(?!\.?\d)")
        self.assert_none([f"{path}: the version is written out; take it from CMake" for path in FILES
                          if path.suffix in (*SOURCE_SUFFIXES, ".txt", ".in", ".xml", ".yaml", ".json")
                          and path.as_posix() not in VERSION_COPIES and copy.search(text_of(path))])

    def test_tables_are_whole(self):
        """A line of dashes follows a heading with as many columns; no table has been joined into one line."""
        problems = []
        for page in PAGES:
            lines = without_code_blocks(text_of(page))
            for number, (heading, line) in enumerate(zip(["", *lines], lines), 1):
                if "|---|" in line and (not re.fullmatch(r"\|(-+\|)+", line) or not heading.startswith("|")
                                        or heading.replace("\\|", "").count("|") != line.count("|")):
                    problems.append(f"{page}:{number}: a table without heading, or joined into one line")
        self.assert_none(problems)

    def test_no_document_outside_the_project_is_cited(self):
        self.assert_none([f"{path}: {found.group()}" for path in FILES
                          if path.suffix in (".cpp", ".hpp", ".txt", ".cmake", ".idl", ".yaml")
                          and (found := re.search(r"DESIGN(?:\.md| section|, section)", text_of(path)))])

    def test_words_are_plain(self):
        problems = []
        for path in FILES:
            prose = path in PAGES or path.parts[0] in ("config", "deploy")
            if not prose:
                continue
            for number, line in enumerate(text_of(path).split("\n"), 1):
                line = re.sub(r"`[^`]*`|\"[^\"]*\"", "", line)
                problems += [f"{path}:{number}: '{found.group()}': write: {instead}"
                             for pattern, instead in WORDS.items() if (found := re.search(pattern, line))]
        self.assert_none(problems)

    def test_words_of_names_are_plain(self):
        problems = []
        for path in FILES:
            checked = path in PAGES or path.suffix in CODE_SUFFIXES or GOLDEN.search(path.as_posix()) \
                or path.name == "CMakeLists.txt" or path.parts[0] in ("config", "deploy")
            if not checked or path.name == "docs_test.py":
                continue
            for number, line in enumerate(text_of(path).split("\n"), 1):
                for exception in WORD_EXCEPTIONS:
                    line = re.sub(exception, "", line)
                problems += [f"{path}:{number}: '{word}': write: {PLAIN_WORDS[word]}"
                             for word in sorted(words_of(line) & PLAIN_WORDS.keys())]
        self.assert_none(problems)


if __name__ == "__main__":
    unittest.main()
