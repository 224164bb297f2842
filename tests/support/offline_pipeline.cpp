// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/offline_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>

#include "services/camera/core/source_factory.hpp"
#include "services/filter/core/orb_extractor.hpp"
#include "services/launcher/core/evaluation/ate.hpp"
#include "services/launcher/core/evaluation/rpe.hpp"

namespace rtd::test_support {
namespace {

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// ORB features, with those on the source's mask removed.
class MaskedOrb final : public FrontEnd {
 public:
  explicit MaskedOrb(bool use_mask) : use_mask_(use_mask) {}

  std::vector<msg::Feature> process(const camera::SourceFrame& frame) override {
    std::vector<msg::Feature> features = extractor_.extract(frame.image);
    if (!use_mask_) return features;
    if (frame.dynamic_mask.empty()) throw std::invalid_argument("true-mask: the source has no masks (tum:DIR?masks=1)");
    constexpr int kGrow_px = 3;
    cv::Mat grown;
    cv::dilate(frame.dynamic_mask, grown,
               cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kGrow_px + 1, 2 * kGrow_px + 1}));
    for (msg::Feature& feature : features) {
      const int x = std::clamp(static_cast<int>(std::lround(feature.u_raw_px)), 0, grown.cols - 1);
      const int y = std::clamp(static_cast<int>(std::lround(feature.v_raw_px)), 0, grown.rows - 1);
      if (grown.at<std::uint8_t>(y, x) != 0) feature.flags |= msg::kFeatureRemoved;
    }
    return features;
  }

 private:
  filter::OrbExtractor extractor_{filter::OrbConfig{}};
  bool use_mask_;
};

void add_stage_times(const msg::TrackingResult& result, OfflineReport& report) {
  static constexpr std::array<const char*, 6> kNames{"slam.match",    "slam.local_map", "slam.pose",
                                                     "slam.keyframe", "slam.mapping",   "slam.total"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    report.stage_ms[kNames[i]].push_back(static_cast<double>(result.stage_ms[i]));
  }
  report.stage_ms["slam.tracking"].push_back(
      static_cast<double>(result.stage_ms[msg::kStageSlamTotal] - result.stage_ms[msg::kStageMapping]));
}

void evaluate(OfflineReport& report) {
  report.coverage = report.frames == 0 ? 0.0 : static_cast<double>(report.tracked) / static_cast<double>(report.frames);
  report.ate_rmse_m = eval::ate(report.trajectory, report.groundtruth).error_m.rmse;
  const eval::RpeResult rpe = eval::rpe(report.trajectory, report.groundtruth);
  report.rpe_trans_rmse_m = rpe.translation_m.rmse;
  report.rpe_rot_rmse_deg = rpe.rotation_rad.rmse * 180 / std::numbers::pi;
}

}  // namespace

std::unique_ptr<FrontEnd> make_front_end(const std::string& mode) {
  if (mode == "off" || mode == "true-mask") return std::make_unique<MaskedOrb>(mode == "true-mask");
  throw std::invalid_argument("unknown mode '" + mode + "': off, true-mask");
}

std::unique_ptr<msg::FeatureFrame> make_feature_frame(const vision::RgbdImage& image,
                                                      const std::vector<msg::Feature>& features) {
  auto message = std::make_unique<msg::FeatureFrame>();
  message->seq = image.seq;
  message->stamp_ns = image.stamp_ns;
  const geometry::CameraModel::Parameters& camera = image.camera.parameters();
  message->intrinsics = {camera.fx, camera.fy, camera.cx, camera.cy};
  message->width = static_cast<std::uint32_t>(image.color_bgr.cols);
  message->height = static_cast<std::uint32_t>(image.color_bgr.rows);
  message->count = static_cast<std::uint32_t>(std::min<std::size_t>(features.size(), msg::kMaxFeatures));
  std::copy_n(features.begin(), message->count, message->features.begin());
  return message;
}

OfflineReport run_offline(const OfflineOptions& options) {
  const auto source = camera::make_source(options.source);
  const auto front_end = make_front_end(options.mode);
  slam::SlamSystem slam(options.slam, options.mapping, steady_ns);
  OfflineReport report;
  while (options.max_frames == 0 || report.frames < options.max_frames) {
    const auto frame = source->next();
    if (!frame) break;
    const std::int64_t start_ns = steady_ns();
    const auto message = make_feature_frame(frame->image, front_end->process(*frame));
    report.stage_ms["front_end"].push_back(static_cast<double>(steady_ns() - start_ns) * 1e-6);
    const slam::SlamOutput output = slam.process(*message);
    front_end->listen(output);
    add_stage_times(output.result, report);
    report.keyframes = output.result.keyframes;
    report.landmarks = output.result.landmarks;
    ++report.frames;
    if (output.result.state == msg::TrackingState::kOk) ++report.tracked;
    if (options.on_frame) options.on_frame(output);
  }
  slam.finish();
  std::ostringstream text;
  slam::write_tum_trajectory(text, slam.trajectory());
  report.trajectory_tum = text.str();
  for (const slam::StampedPose& pose : slam.trajectory())
    report.trajectory.push_back({pose.stamp_ns, pose.T_world_camera});
  for (const camera::StampedPose& pose : source->groundtruth()) {
    report.groundtruth.push_back({pose.stamp_ns, pose.T_world_camera});
  }
  evaluate(report);
  return report;
}

}  // namespace rtd::test_support
