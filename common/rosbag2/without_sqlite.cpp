// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/rosbag2/db3_reader.hpp"

namespace rtd::rosbag2 {

void Db3Reader::Close::operator()(sqlite3* /*database*/) const {}

Db3Reader::Db3Reader(const std::filesystem::path& path) : path_(path) {
  fail("this build reads no .db3 files; install libsqlite3-dev, then configure and build again");
}

std::vector<Db3Place> Db3Reader::messages(const std::vector<std::string>& /*topics*/) const {
  return {};
}

std::vector<std::uint8_t> Db3Reader::read(const Db3Place& /*place*/) {
  return {};
}

void Db3Reader::fail(const std::string& what) const {
  throw Db3Error(path_.string() + ": " + what);
}

}  // namespace rtd::rosbag2
