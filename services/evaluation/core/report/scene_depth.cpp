// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/scene_depth.hpp"

#include <vector>

#include "common/camera/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/run_record/run_record.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {
namespace {

constexpr int kFrames = 60, kFrameStep = 15, kPixelStep = 8;

void add_depths(const vision::RgbdImage& image, std::vector<double>& depths_m) {
  for (int row = 0; row < image.depth.rows; row += kPixelStep) {
    for (int column = 0; column < image.depth.cols; column += kPixelStep) {
      const std::uint16_t depth = image.depth.at<std::uint16_t>(row, column);
      if (depth > 0) depths_m.push_back(depth * image.depth_scale_m);
    }
  }
}

}  // namespace

std::optional<double> scene_depth_m(const std::string& source_uri) {
  const bool folder = camera::is_of_kind(source_uri, camera::SourceKind::kFolder);
  if (!folder && !run_record::is_synthetic(source_uri)) return std::nullopt;
  std::vector<double> depths_m;
  try {
    const auto source = camera::make_source(source_uri);
    for (int i = 0; i < kFrames; ++i) {
      const auto frame = source->next();
      if (!frame) break;
      if (i % kFrameStep == 0) add_depths(frame->image, depths_m);
    }
  } catch (const std::exception&) {  // the source is no longer there: the depth is not known
  }
  if (depths_m.empty()) return std::nullopt;
  return percentile(depths_m, 0.75);
}

}  // namespace rtd::eval
