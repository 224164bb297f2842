// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/trace_file.hpp"

#include <filesystem>
#include <fstream>
#include <set>

namespace rtd::launcher {
namespace fs = std::filesystem;

std::string join_trace(const std::string& folder, const std::string& path) {
  std::ofstream joined(path);
  joined << R"({"displayTimeUnit":"ms","traceEvents":[)";
  std::error_code error;
  std::set<fs::path> parts;  // by name: the same order each time
  for (const auto& entry : fs::directory_iterator(folder, error)) parts.insert(entry.path());
  if (error) return folder + ": " + error.message();
  const char* separator = "\n";
  for (const fs::path& part : parts) {
    std::ifstream lines(part);
    for (std::string line; std::getline(lines, line);) {
      if (!line.ends_with("}}")) continue;
      joined << separator << line;
      separator = ",\n";
    }
  }
  joined << "\n]}\n";
  joined.close();
  if (!joined) return path + ": cannot be written";
  fs::remove_all(folder, error);
  return error ? folder + ": " + error.message() : "";
}

}  // namespace rtd::launcher
