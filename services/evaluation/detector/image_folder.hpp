// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/detector/core/evaluation/labels.hpp"

namespace rtd::eval {

/// Every `step`-th image of a folder (jpg, jpeg, png, bmp), by name. `option` names the folder on the command line.
/// Throws EvalDetectorError when the folder is missing or contains no image.
std::vector<std::filesystem::path> images_in(const std::string& folder, const std::string& option, int step);

/// The file in `folder` that has the same name as `image` and one of the `endings`; empty when there is none.
std::filesystem::path partner_of(const std::filesystem::path& image, const std::string& folder,
                                 const std::vector<std::string>& endings);

/// Throws EvalDetectorError when `folder` is not a folder.
void require_folder(const std::string& folder, const std::string& option);

/// A folder of label files named like the images.
class LabelFolder {
 public:
  /// `format`: yolo (.txt), voc (.xml) or auto (the format in the folder). Throws EvalDetectorError when the folder is
  /// missing, or when auto finds both formats or none.
  LabelFolder(const std::string& folder, const std::string& format);

  const std::string& format() const { return format_; }
  /// Whether the image has a label file; without one it has no objects.
  bool has(const std::filesystem::path& image) const;
  detector::ImageLabels read(const std::filesystem::path& image, detector::ImageSize size,
                             const std::vector<std::string>& class_names) const;

 private:
  std::filesystem::path file_of(const std::filesystem::path& image) const;
  std::string folder_, format_;
};

}  // namespace rtd::eval
