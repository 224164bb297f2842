// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/mcap/writer.hpp"

/// The conformance set of the MCAP format: per case a JSON text with the records that a file holds (contents of chunks
/// in line, without Chunk and MessageIndex), the features that it was written with, and the file.
namespace rtd::mcap {

struct ConformanceCase {
  std::string name;
  std::filesystem::path mcap;  ///< the file, or the Git LFS pointer to it: its SHA-256 and size
  nlohmann::json records;
  std::set<std::string> features;
};

/// All cases below RTD_DATA_DIR/mcap_conformance; none when it is not there.
std::vector<ConformanceCase> conformance_cases();

/// The file that our writer makes of the records of the data section with the options that the features name.
Bytes write_case(const ConformanceCase& test);

/// The records that our streaming reader delivers, as the JSON has them; problems go to `problems`.
nlohmann::json read_case(ByteView file, std::string& problems);

/// The messages that our indexed reader delivers (problems other than a missing or partial summary go to `problems`),
/// and those of the data section of the case by log_time.
nlohmann::json read_case_by_index(ByteView file, std::string& problems);
nlohmann::json messages_by_time(const ConformanceCase& test);

}  // namespace rtd::mcap
