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

/// Writes an image file as io::AtomicFile does; its extension names the format. False: the image cannot be encoded so.
/// Throws io::IoError, and what image_codecs() throws.
inline bool write_image(const std::filesystem::path& file, const cv::Mat& image, const std::vector<int>& parameters = {},
                        io::AtomicOptions options = {}) {
  std::vector<std::uint8_t> bytes;
  if (!image_codecs().encode(file.extension().string(), image, bytes, parameters)) return false;
  io::write_file(file, std::as_bytes(std::span(bytes)), options);
  return true;
}

}  // namespace rtd::vision
