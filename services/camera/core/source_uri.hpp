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

}  // namespace rtd::camera
