// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/calibration_request.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/camera/frame_source.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

double parse_in(const std::string& uri, const std::string& key, const std::string& value, double least, double most) {
  const std::optional<double> number = io::parse_number(value);
  if (number && *number >= least && *number <= most) return *number;
  throw SourceError(fmt::format("source '{}': {} is '{}', allowed: {:g} to {:g}", io::abridged(uri), key,
                                io::abridged(value), least, most));
}

std::map<std::string, double> parse_intrinsics(const std::string& uri, const std::string& value) {
  constexpr std::array kKeys = {"fx", "fy", "cx", "cy", "width", "height"};
  std::vector<double> numbers;
  if (const auto lines = io::split_lines(value, ", \t"); !lines.empty()) {
    for (const std::string& field : lines.front().fields) {
      const std::optional<double> number = io::parse_number(field);
      if (number && std::isfinite(*number)) numbers.push_back(*number);
    }
    if (numbers.size() != lines.front().fields.size()) numbers.clear();
  }
  if (numbers.size() != 4 && numbers.size() != kKeys.size()) {
    throw SourceError("source '" + io::abridged(uri) + "': intrinsics is '" + io::abridged(value) +
                      "'; write fx,fy,cx,cy or fx,fy,cx,cy,width,height in px");
  }
  std::map<std::string, double> intrinsics;
  for (std::size_t i = 0; i < numbers.size(); ++i) intrinsics[kKeys[i]] = numbers[i];
  return intrinsics;
}

}  // namespace

bool take_calibration_parameter(CalibrationRequest& request, const std::string& uri, const std::string& key,
                                const std::string& value) {
  if (key == "calibration") {
    request.file = value;
  } else if (key == "intrinsics") {
    request.intrinsics = parse_intrinsics(uri, value);
  } else if (key == "depth_factor") {
    request.depth_factor = parse_in(uri, key, value, 1, 1e6);
  } else if (key == "fps") {
    request.fps = parse_in(uri, key, value, 0.1, 1000);
  } else {
    return false;
  }
  return true;
}

Calibration requested_calibration(const CalibrationRequest& request, const std::filesystem::path& folder,
                                  std::optional<cv::Size> image_px) {
  if (!request.intrinsics.empty()) return make_calibration(request.intrinsics, "?intrinsics=", image_px);
  std::filesystem::path file = request.file;
  std::error_code error;
  if (!std::filesystem::exists(file, error) && std::filesystem::exists(folder / file, error)) file = folder / file;
  return read_calibration(file, image_px);
}

}  // namespace rtd::camera
