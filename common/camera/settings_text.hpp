// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::camera {

/// The values of a settings file of another program by their paths: "Camera.fx", "cam0.intrinsics". Reads more than
/// strict parsers do, because people's files are not strict: YAML with OpenCV's `%YAML:1.0` and tags, `key:value`
/// without a blank, `key = value`, JSON. What it does not understand it passes over, and paths of more than 256 bytes.
/// Takes time and memory in proportion to the text. Immutable.
class SettingsText {
 public:
  explicit SettingsText(std::string_view text);

  struct Entry {
    std::size_t place;  ///< in the order of the file
    std::vector<std::string> values;
  };

  bool has(const std::string& path) const { return entries_.count(path) != 0; }
  /// The first value; empty when there is none.
  std::string text(const std::string& path) const;
  std::optional<double> number(const std::string& path) const;
  /// All values; empty when one of them is not a number.
  std::vector<double> numbers(const std::string& path) const;
  /// The first path that ends with ".NAME" or is NAME; empty when there is none.
  std::string path_of(const std::string& name) const;

 private:
  std::map<std::string, Entry> entries_;
};

}  // namespace rtd::camera
