// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/source_uri.hpp"

#include <filesystem>
#include <sstream>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

SourceUri parse_source_uri(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0) {
    throw SourceError(
        "source '" + text +
        "' has no scheme; write tum:FOLDER, bag:FILE, mcap:FILE, ros2:TOPICS or synthetic:NAME[?key=value&...]");
  }
  SourceUri uri{text, text.substr(0, colon), text.substr(colon + 1), {}};
  const std::size_t question = uri.path.find('?');
  if (question == std::string::npos) return uri;
  std::istringstream parameters(uri.path.substr(question + 1));
  uri.path.resize(question);
  for (std::string part; std::getline(parameters, part, '&');) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw SourceError("source '" + text + "': parameter '" + part + "' is not key=value");
    }
    if (!uri.parameters.emplace(part.substr(0, equals), part.substr(equals + 1)).second) {
      throw SourceError("source '" + text + "': parameter '" + part.substr(0, equals) + "' stands twice");
    }
  }
  return uri;
}

std::string complete_uri(const std::string& source) {
  if (source.find(':') != std::string::npos) return source;
  const std::filesystem::path path = source;
  if (std::filesystem::is_directory(path)) return "tum:" + source;
  if (path.extension() == ".bag") return "bag:" + source;
  return path.extension() == ".mcap" ? "mcap:" + source : source;
}

}  // namespace rtd::camera
