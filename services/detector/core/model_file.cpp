// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/model_file.hpp"

#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

void ModelName::refuse(const std::string& cause) const {
  throw ModelError(kind + " '" + path + "': " + cause + "; run `deploy/setup.sh --models`, or name another file with " +
                   key);
}

std::vector<std::uint8_t> read_model_file(const ModelName& model) {
  try {
    const std::string content = io::read_file(model.path, io::kNetwork);
    if (content.empty()) model.refuse("is empty");
    return {content.begin(), content.end()};
  } catch (const io::IoError& error) {
    model.refuse(error.what());
  }
}

}  // namespace rtd::detector
