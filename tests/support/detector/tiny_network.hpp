// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace rtd::test {

/// Which bytes tiny_network_onnx() writes.
struct TinyNetwork {
  int width_px = 64, height_px = 64;
  int class_count = 2;
  bool fixed_size = true;         ///< false: height and width are free dimensions
  bool free_batch = false;        ///< takes several images at once
  std::vector<int> reshape = {};  ///< if any: a Reshape of the images to this shape, whose output has no use
  bool reshape_by_node = false;   ///< the shape is the output of a Constant node, not an initializer
  std::vector<int> strides = {8, 16, 32};
  std::map<std::string, std::string> metadata = {};
  std::function<float(float)> spoil = {};  ///< what every weight and bias becomes; empty = itself
};

/// An ONNX network with YOLOv5 heads that needs no training: per stride one convolution over whole cells. Anchor 0 of a
/// cell has objectness logit 40 * mean brightness - 20 (white: 20, black: -20) and class 0; box offsets are 0, so the
/// box is the anchor centred on the cell. All other anchors have objectness -20.
std::string tiny_network_onnx(const TinyNetwork& network);

/// A network for person masks of 64 x 64 px: the probability is the mean brightness of the pixel.
std::string tiny_mask_network_onnx();

}  // namespace rtd::test
