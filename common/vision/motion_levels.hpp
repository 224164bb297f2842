// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

namespace rtd::vision {

/// How likely objects of a class move by themselves or in a person's hand (paper section III-B).
enum class MotionLevel {
  kHigh,    ///< moves by itself: person, animals, vehicles
  kMedium,  ///< is moved by people: chair, book, cup, ...
  kLow,     ///< hardly ever moves: tv, refrigerator, ...
};

/// Class name -> motion level: the table of docs/theory/dynamic_points.md with the entries of the configuration over
/// it.
class MotionLevels {
 public:
  /// `overrides`: class -> "high" | "medium" | "low" | "none"; throws std::invalid_argument naming class and value
  /// otherwise.
  explicit MotionLevels(const std::map<std::string, std::string>& overrides = {});
  /// The same classes, all of them high.
  MotionLevels all_high() const;
  /// Empty: the class does not matter to us.
  std::optional<MotionLevel> find(const std::string& class_name) const;

 private:
  std::map<std::string, MotionLevel> levels_;
};

}  // namespace rtd::vision
