// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/detector/core/evaluation/labels.hpp"

namespace rtd::launcher {

/// A folder of label files named like the images.
class LabelFolder {
 public:
  /// `format`: yolo (.txt), voc (.xml) or auto: what the folder has. Throws EvalDetectorError when there is no such
  /// folder, or auto finds both formats or none.
  LabelFolder(const std::string& folder, const std::string& format);

  const std::string& format() const { return format_; }
  /// False: no file, and so no objects.
  bool has(const std::filesystem::path& image) const;
  detector::ImageLabels read(const std::filesystem::path& image, detector::ImageSize size,
                             const std::vector<std::string>& class_names) const;

 private:
  std::filesystem::path file_of(const std::filesystem::path& image) const;
  std::string folder_, format_;
};

}  // namespace rtd::launcher
