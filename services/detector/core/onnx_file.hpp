// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <opencv2/core/utils/logger.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/detector/core/detector_config.hpp"

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

/// Height and width of an image input, px.
struct InputSize {
  int width_px = 0, height_px = 0;
};

/// Metadata of an ONNX file. OpenCV 4.6 gives no access to it.
struct OnnxFile {
  bool has_graph = false;          ///< false: these bytes are not an ONNX model, or only the beginning of one
  std::optional<InputSize> input;  ///< of the first Nx3xHxW input, when H and W are fixed
  bool free_batch = false;  ///< its N is not fixed, and every Reshape has a constant shape that copies it (0 first)
  std::map<std::string, std::string> metadata;  ///< ModelProto.metadata_props
  std::uint64_t parameters = 0;                 ///< numbers in the float tensors of the graph
};

/// Reads ONNX bytes (protobuf wire format, field numbers of onnx.proto). Never reads outside the bytes, whatever they
/// hold.
OnnxFile read_onnx_file(const std::uint8_t* bytes, std::size_t size);

/// Anchors and strides as our converter writes them, one head a line: "8: 10,13 16,30 33,23". Empty when malformed.
std::vector<HeadLayout> parse_heads(const std::string& text);

/// The lines of `text`.
std::vector<std::string> split_lines(const std::string& text);

}  // namespace rtd::detector
