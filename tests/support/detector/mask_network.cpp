// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/detector/mask_network.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "common/service/model_locator.hpp"

namespace rtd::test {
namespace fs = std::filesystem;
namespace {

/// A file that ends with the program.
struct TemporaryFile {
  std::string path;
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

}  // namespace

std::string mask_network() {
  const service::ModelSearch there = service::find_model(service::kMaskModel.file, service::process_environment());
  if (there) return there.path;
  const char* const folder = std::getenv("RTD_MODEL_DIR");
  const fs::path source = fs::path(folder == nullptr ? "/nowhere" : folder) / "permissive/selfie_segmentation.tflite";
  static const TemporaryFile converted{
      (fs::temp_directory_path() / ("rtd_masks_" + std::to_string(getpid()) + ".onnx")).string()};
  if (fs::exists(converted.path)) return converted.path;
  if (!fs::exists(source)) return {};
  const std::string command =
      "/usr/bin/python3 -B '" MASK_CONVERTER "' '" + source.string() + "' '" + converted.path + "' >/dev/null";
  return std::system(command.c_str()) == 0 ? converted.path : std::string();
}

}  // namespace rtd::test
