// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/filter_quality.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace {

using rtd::msg::Feature;

/// Removed features red, features found at their place green, the others blue.
void draw(const rtd::vision::RgbdImage& image, const rtd::filter::FilterResult& result, const std::string& folder) {
  cv::Mat canvas = image.color_bgr.clone();
  for (const Feature& feature : result.features) {
    cv::Scalar color(255, 160, 0);
    if ((feature.flags & rtd::msg::kFeatureGeometryStatic) != 0) color = cv::Scalar(0, 220, 0);
    if ((feature.flags & rtd::msg::kFeatureRemoved) != 0) color = cv::Scalar(0, 0, 255);
    cv::circle(canvas, cv::Point2f(feature.u_raw_px, feature.v_raw_px), 3, color);
  }
  cv::imwrite(folder + "/" + std::to_string(image.seq) + ".png", canvas);
}

}  // namespace

/// Precision, recall, own pose error and stage times of the filter's geometry on a clip with masks.
int main(int argc, char** argv) {
  CLI::App app("Quality of the dynamic filter by geometry alone, without detector and slam");
  std::string clip_folder, picture_folder;
  bool verbose = false;
  app.add_option("clip", clip_folder, "folder in TUM layout with mask/")->required();
  app.add_option("--pictures", picture_folder, "write every tenth frame with its features here");
  app.add_flag("--verbose", verbose, "a line per frame");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  rtd::filter::FilterConfig config;
  config.mode = rtd::filter::FilterMode::kGeometry;
  try {
    const rtd::test_support::EvaluationClip clip(clip_folder);
    const auto quality = rtd::test_support::measure_filter(clip, config, [&](const auto& image, const auto& result) {
      if (verbose) {
        std::printf("%4lu features %4zu removed %4u clusters %u pose %s\n", static_cast<unsigned long>(image.seq),
                    result.features.size(), result.removed, result.dynamic_clusters,
                    result.pose_reliable ? "ok" : "none");
      }
      if (!picture_folder.empty() && image.seq % 10 == 0) draw(image, result, picture_folder);
    });
    const auto& ms = quality.stage_ms;
    std::printf("precision %.4f  recall %.4f  removed wrongly %.1f a frame  worst own pose error %.4f m\n",
                quality.precision(), quality.recall(), quality.removed_wrongly_per_frame(), quality.max_pose_error_m);
    std::printf("ms: extract %.2f  ego motion %.2f  depth check %.2f  fuse %.2f  total %.2f\n",
                ms[rtd::msg::kStageExtract], ms[rtd::msg::kStageEgoMotion], ms[rtd::msg::kStageDepthCheck],
                ms[rtd::msg::kStageFuse], ms[rtd::msg::kStageFilterTotal]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
