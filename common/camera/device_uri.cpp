// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/device_uri.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/camera/frame_source.hpp"
#include "common/camera/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

double parse_mode_value(const std::string& uri, const std::string& key, const std::string& value, double most) {
  const std::optional<double> number = io::parse_number(value);
  if (number && *number >= 1 && *number <= most) return *number;
  throw SourceError(
      fmt::format("source '{}': {} is '{}', allowed: 1 to {:g}", io::abridged(uri), key, io::abridged(value), most));
}

void take_parameter(DeviceUri& uri, const std::string& key, const std::string& value) {
  constexpr double kMaxSide = 8192, kMaxFps = 300;
  if (key == "calibration") {
    uri.calibration_file = value;
  } else if (key == "tolerance_ms") {
    uri.tolerance_ns = parse_tolerance_ns(uri.text, value);
  } else if (key == "width") {
    uri.mode.width = static_cast<int>(parse_mode_value(uri.text, key, value, kMaxSide));
  } else if (key == "height") {
    uri.mode.height = static_cast<int>(parse_mode_value(uri.text, key, value, kMaxSide));
  } else if (key == "fps") {
    uri.mode.fps = parse_mode_value(uri.text, key, value, kMaxFps);
  } else {
    throw SourceError("source '" + io::abridged(uri.text) + "': unknown parameter '" + io::abridged(key) + "'; " +
                      uri.scheme + ": knows calibration, tolerance_ms, width, height, fps");
  }
}

}  // namespace

bool is_device(const std::string& uri) {
  return is_of_kind(uri, SourceKind::kDevice);
}

DeviceUri parse_device_uri(const std::string& text) {
  const SourceUri parsed = parse_source_uri(text);
  DeviceUri uri{text, parsed.scheme, parsed.path, {}, {}, kPairingToleranceNs, false};
  uri.recorded = uri.scheme == "openni2" && uri.device.ends_with(".oni");
  for (const auto& [key, value] : parsed.parameters) take_parameter(uri, key, value);
  return uri;
}

}  // namespace rtd::camera
