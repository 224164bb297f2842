// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::eval {

/// Size of an image, px.
struct ImageSize {
  int width_px = 0, height_px = 0;
};

/// A labelled object: an axis-parallel box, top-left corner and size, px.
struct LabelledBox {
  std::string class_name;
  double x_px = 0, y_px = 0, width_px = 0, height_px = 0;
  bool difficult = false;  ///< VOC: neither finding it nor missing it counts
};

/// The objects of one image, and what was wrong with the file. What was wrong is left out of `boxes`.
struct ImageLabels {
  std::vector<LabelledBox> boxes;
  std::vector<std::string> problems;  ///< "file:line: what, value, what is allowed"
};

/// A label file as it was read.
struct LabelFile {
  std::string name;  ///< for messages
  std::string text;
};

/// YOLO: a line per object, `class cx cy w h`, centre and size as shares of the image. Empty text = no objects.
ImageLabels parse_yolo_labels(const LabelFile& file, ImageSize image, const std::vector<std::string>& class_names);

/// Pascal VOC: `<annotation><object><name>, <bndbox>` with pixels counted from 1 to the last one inside. Boxes are
/// scaled when `<size>` names another size than the image has.
ImageLabels parse_voc_labels(const LabelFile& file, ImageSize image);

}  // namespace rtd::eval
