// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace rtd::camera {

/// "scheme:path?key=value&key=value".
struct SourceUri {
  std::string text, scheme, path;
  std::map<std::string, std::string> parameters;
};

/// Throws SourceError naming the malformed part and the form expected.
SourceUri parse_source_uri(const std::string& text);

/// Adds the scheme that a path leaves out: a folder is a TUM sequence, FILE.bag and FILE.mcap are recordings.
/// Everything else stays as it is.
std::string complete_uri(const std::string& source);

}  // namespace rtd::camera
