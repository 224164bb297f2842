// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/detector/mask_network.hpp"

#include <cstdlib>
#include <filesystem>

#include "common/service/model_locator.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::test {
namespace fs = std::filesystem;
std::string mask_network() {
  const service::ModelSearch there = service::find_model(service::kMaskModel.file, service::process_environment());
  if (there) return there.path;
  const char* const folder = std::getenv("RTD_MODEL_DIR");
  const fs::path source = fs::path(folder == nullptr ? "/nowhere" : folder) / "permissive/selfie_segmentation.tflite";
  static const TemporaryFolder folder_of_converted;
  const std::string converted = folder_of_converted.file("masks.onnx");
  if (fs::exists(converted)) return converted;
  if (!fs::exists(source)) return {};
  const std::string command =
      "/usr/bin/python3 -B '" MASK_CONVERTER "' '" + source.string() + "' '" + converted + "' >/dev/null";
  return std::system(command.c_str()) == 0 ? converted : std::string();
}

}  // namespace rtd::test
