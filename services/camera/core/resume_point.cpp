// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/resume_point.hpp"

#include <sstream>

namespace rtd::camera {

std::optional<ResumePoint> parse_resume_point(const std::string& text) {
  std::istringstream fields(text);
  ResumePoint point;
  char first = 0, second = 0;
  fields >> point.seq >> first >> point.stamp_ns >> second >> point.published_ns;
  if (fields.fail() || !fields.eof() || first != ',' || second != ',') return std::nullopt;
  return point;
}

}  // namespace rtd::camera
