// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
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

/// The value of `tolerance_ms`, ns: more than 0, at most 1000 ms. Throws SourceError naming the URI.
std::int64_t parse_tolerance_ns(const std::string& uri, const std::string& value);
/// The value of a parameter that is 0 or 1. Throws SourceError naming URI and key.
bool parse_flag(const std::string& uri, const std::string& key, const std::string& value);

/// Adds the scheme that a path, with or without ?key=value, leaves out: a folder holds frames (tum: where it has TUM's
/// lists) or a recording, FILE.bag, FILE.db3, FILE.mcap and FILE.oni are
/// recordings. Everything else stays as it is.
std::string complete_uri(const std::string& source);

}  // namespace rtd::camera
