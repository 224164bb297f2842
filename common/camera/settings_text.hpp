// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rtd::camera {

/// The values of a settings file of another program by their paths: "Camera.fx", "cam0.intrinsics". Reads more than
/// strict parsers do, because people's files are not strict: YAML with OpenCV's `%YAML:1.0` and tags, `key:value`
/// without a blank, `key = value`, JSON. What it does not understand it passes over. Immutable.
class SettingsText {
 public:
  explicit SettingsText(std::string_view text);

  bool has(const std::string& path) const { return find(path) != nullptr; }
  /// The first value; empty when there is none.
  std::string text(const std::string& path) const;
  std::optional<double> number(const std::string& path) const;
  /// All values; empty when one of them is not a number.
  std::vector<double> numbers(const std::string& path) const;
  /// The first path that ends with ".NAME" or is NAME; empty when there is none.
  std::string path_of(const std::string& name) const;

 private:
  using Entry = std::pair<std::string, std::vector<std::string>>;
  const Entry* find(const std::string& path) const;

  std::vector<Entry> entries_;  ///< in the order of the file
};

}  // namespace rtd::camera
