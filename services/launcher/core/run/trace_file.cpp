// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/trace_file.hpp"

#include <filesystem>
#include <ostream>
#include <set>

#include "common/io/atomic_file.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;

namespace {

/// Lines that are whole: a killed process leaves half a line.
void join_parts(const std::set<fs::path>& parts, std::ostream& joined) {
  joined << R"({"displayTimeUnit":"ms","traceEvents":[)";
  const char* separator = "\n";
  for (const fs::path& part : parts) {
    io::InputStream lines(part);
    for (std::string line; io::get_line(lines, line);) {
      if (!line.ends_with("}}")) continue;
      joined << separator << line;
      separator = ",\n";
    }
  }
  joined << "\n]}\n";
}

}  // namespace

std::string join_trace(const std::string& folder, const std::string& path) {
  std::error_code error;
  std::set<fs::path> parts;  // by name: the same order each time
  for (const auto& entry : fs::directory_iterator(folder, error)) parts.insert(entry.path());
  if (error) return folder + ": " + error.message();
  try {
    io::write_file(path, [&](std::ostream& joined) { join_parts(parts, joined); },
                   {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& failure) {
    return failure.what();
  }
  fs::remove_all(folder, error);
  return error ? folder + ": " + error.message() : "";
}

}  // namespace rtd::launcher
