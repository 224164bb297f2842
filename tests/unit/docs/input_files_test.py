#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the product opens files and lists folders in one way: by common/io/input_file.hpp, byte_source.hpp and
folder_walk.hpp, which wait for no pipe and know a bound. Everything else stands here with the reason."""
import functools
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
OPENS = re.compile(r"\bifstream\b|\bfstream \w|filebuf\b|\bf(?:re)?open\(|\bopen(?:at)?\(.*\bO_[A-Z]|\bLoadFile\(|"
                   r"\bimread\(|\bVideoCapture\b|\bFileStorage\b|\bsqlite3_open|\bBIO_new_file\(|"
                   r"\b(?:fd)?opendir\(|directory_iterator\b")
WORDS = ("stream", "open", "filebuf", "LoadFile", "imread", "VideoCapture", "FileStorage", "BIO_new_file",
         "directory_iterator")  # of which each such line has one: found sooner than OPENS
COMMENT = re.compile(r"(?:^|\s)//.*")

KERNEL = "text of the kernel in /proc and /sys"
OWN_FOLDER = "a folder that this user's programs write"
ALLOWED = {
    "common/io/byte_source.cpp": "the one way",
    "common/io/input_file.cpp": "the one way; pipes that the user has handed over",
    "common/io/input_file.hpp": "a stream over a file opened in the one way",
    "common/io/folder_walk.cpp": "the one way",
    "common/io/atomic_file.cpp": "opens for writing; looks for what killed processes left beside its file",
    "common/io/byte_sink.cpp": "opens for writing",
    "common/io/fd_writing.cpp": "opens the folder of a file to write",
    "common/io/named_files.cpp": "looks at a name of a command, without waiting and following links",
    "common/bus/network.cpp": KERNEL,
    "common/bus/host/host_checks.cpp": KERNEL,
    "common/bus/port_check.cpp": KERNEL,
    "common/bus/host/ring_folder.cpp": "/dev/shm, without following links",
    "common/bus/host/ring_folder.hpp": "/dev/shm",
    "common/bus/host/shm_leftovers.cpp": KERNEL + ", /dev/shm",
    "common/bus/fastdds/c_library.cpp": "/dev/shm",
    "common/bus/fastdds/participant.cpp": KERNEL,
    "common/bus/fastdds/discovery_listener.cpp": KERNEL,
    "common/concurrency/thread_priority.hpp": KERNEL,
    "common/process/executable.cpp": "folders of programs, of the user's PATH",
    "common/process/out_folder.cpp": "the lock of a folder of results, without waiting and following links",
    "common/process/posix_process_host.cpp": KERNEL + ", /dev/null",
    "common/rosbag2/db3_reader.cpp": "SQLite opens by name what was seen to be a regular file",
    "common/security/enclave.cpp": "the user's own keystore; links to folders are not followed",
    "common/service/model_locator.cpp": "folders of installed libraries and of models",
    "common/service/peer_table.cpp": KERNEL,
    "common/service/standard_streams.hpp": "/dev/null",
    "services/evaluation/core/datasets/openloris.cpp": "OpenCV reads a text in memory",
    "services/launcher/run/run_command.cpp": OWN_FOLDER,
    "services/launcher/run/run_setup.cpp": OWN_FOLDER,
    "services/recorder/core/output_files.cpp": OWN_FOLDER,
    "services/viewer/web/site.cpp": "three.js as it is installed; counts what it sees, follows no links out",
}


@functools.cache
def opening_lines():
    """Pairs (file, line) of all that opens files or lists folders."""
    found = []
    for top in ("common", "services"):
        for path in sorted((ROOT / top).rglob("*")):
            if path.suffix not in (".cpp", ".hpp", ".in"):
                continue
            for line in path.read_text(encoding="utf-8").splitlines():
                if not any(word in line for word in WORDS):
                    continue
                if OPENS.search(line) and OPENS.search(COMMENT.sub("", line)) and "#include" not in line:
                    found.append((path.relative_to(ROOT).as_posix(), line.strip()))
    return found


class InputFiles(unittest.TestCase):
    def test_are_opened_in_one_way(self):
        others = [f"{file}: {line}" for file, line in opening_lines() if file not in ALLOWED]
        self.assertEqual(others, [], "\nopen files of others with io::read_file(), io::InputStream or io::FileSource, "
                                     "list folders with io::FolderWalk")

    def test_exceptions_are_needed(self):
        used = {file for file, _ in opening_lines()}
        self.assertEqual([file for file in ALLOWED if file not in used], [])

    def test_finds_what_opens(self):
        for line in ("std::ifstream in(path);", "fopen(name, \"r\")", "::open(path, O_RDONLY)", "YAML::LoadFile(file)",
                     "cv::imread(file)", "std::fstream both(path);", "for (auto& e : fs::directory_iterator(folder))",
                     "int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);", "fs::recursive_directory_iterator i(f);"):
            self.assertTrue(OPENS.search(line), line)
        for line in ("device_->open(uri);", "std::ofstream out(path);", "source.open();", "opened(path)"):
            self.assertFalse(OPENS.search(line), line)


if __name__ == "__main__":
    unittest.main()
