// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/utils/logger.hpp>
#include <string>
#include <vector>

namespace rtd::detector {

/// A configured network, for messages.
struct ModelName {
  std::string kind;  ///< "detector model"
  std::string key;   ///< "detector.model"
  std::string path;

  /// Throws ModelError with kind, path, cause and fix.
  [[noreturn]] void refuse(const std::string& cause) const;
};

/// All bytes of the file. Throws ModelError when it is missing, cannot be read or is empty.
std::vector<std::uint8_t> read_model_file(const ModelName& model);

/// OpenCV logs what it throws; where this lives the exception is enough.
class QuietOpenCv {
 public:
  QuietOpenCv() : saved_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(saved_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel saved_;
};

}  // namespace rtd::detector
