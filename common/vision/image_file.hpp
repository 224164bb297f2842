// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "common/io/atomic_file.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::vision {

/// Writes an image file as io::AtomicFile does, encoded by its extension: .png, .jpg or .jpeg. False: another extension,
/// or the image cannot be encoded. Throws io::IoError.
inline bool write_image(const std::filesystem::path& file, const cv::Mat& image, io::AtomicOptions options = {}) {
  const std::vector<std::uint8_t> bytes = encode_image(file.extension().string(), image);
  if (bytes.empty()) return false;
  io::write_file(file, std::as_bytes(std::span(bytes)), options);
  return true;
}

}  // namespace rtd::vision
