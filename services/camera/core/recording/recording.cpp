// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/recording.hpp"

#include <utility>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {
namespace {

void replace(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from))
    text.replace(at, from.size(), to);
}

}  // namespace

std::string plain_type(std::string type) {
  if (type.find("::dds_::") != std::string::npos && type.back() == '_') type.pop_back();
  replace(type, "::dds_::", "::");
  replace(type, "::", "/");
  replace(type, "/msg/", "/");
  return type;
}

RecordedMessage first_of(Recording& recording, const std::string& topic) {
  std::optional<RecordedMessage> message = recording.first(topic);
  if (message) return std::move(*message);
  std::string cause = "none of its messages can be read";
  if (const auto damages = recording.take_damages(); !damages.empty()) cause += ": " + damages.front();
  throw SourceError(recording.name() + ", topic " + topic + ": " + cause);
}

}  // namespace rtd::camera
