// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/decoders/decoder.hpp"

#include "services/detector/core/decoders/nanodet.hpp"
#include "services/detector/core/decoders/yolov5.hpp"
#include "services/detector/core/decoders/yolox.hpp"

namespace rtd::detector {

const std::vector<DecoderFamily>& decoder_families() {
  static const std::vector<DecoderFamily> families = {yolov5_family(), yolox_family(), nanodet_family()};
  return families;
}

std::string decoder_names() {
  std::string text;
  for (const DecoderFamily& family : decoder_families()) text += (text.empty() ? "" : ", ") + std::string(family.name);
  return text;
}

std::string shape_text(const std::vector<int>& shape) {
  if (shape.empty()) return "unsupported";
  std::string text;
  for (const int size : shape) text += (text.empty() ? "" : "x") + std::to_string(size);
  return text;
}

std::string shapes_text(const std::vector<RawOutput>& outputs) {
  std::string text;
  for (const RawOutput& output : outputs) text += (text.empty() ? "" : " ") + shape_text(output.shape);
  return text;
}

}  // namespace rtd::detector
