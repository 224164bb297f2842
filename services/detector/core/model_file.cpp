// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/model_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

void ModelName::refuse(const std::string& cause) const {
  throw ModelError(kind + " '" + path + "': " + cause + "; run `deploy/setup.sh --models`, or name another file with " +
                   key);
}

std::vector<std::uint8_t> read_model_file(const ModelName& model) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(model.path, ignored)) model.refuse("there is no such file");
  std::ifstream file(model.path, std::ios::binary);
  if (!file) model.refuse("cannot be opened");
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.empty()) model.refuse("is empty");
  return bytes;
}

}  // namespace rtd::detector
