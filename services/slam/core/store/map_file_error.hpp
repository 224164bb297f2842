// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace rtd::slam {

enum class MapFileDefect {
  kNotAMap,  ///< another kind of file
  kVersion,  ///< a map file of another version of the format
  kDamaged,  ///< cut, changed, or not what a map can be
};

/// A file cannot be read as a map: what() says where, why and what can be done.
class MapFileError : public std::runtime_error {
 public:
  MapFileError(MapFileDefect defect, const std::string& what) : std::runtime_error(what), defect_(defect) {}
  MapFileDefect defect() const { return defect_; }

 private:
  MapFileDefect defect_;
};

}  // namespace rtd::slam
