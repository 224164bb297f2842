// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "common/msg/transform_eigen.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/filter/config.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "services/filter/filter_messages.hpp"
#include "services/slam/slam_messages.hpp"
#include "tests/support/detector_pace.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

double ms_since(std::int64_t start_ns) {
  return static_cast<double>(service::monotonic_ns() - start_ns) * 1e-6;
}

/// ORB features; with the source's mask those on moving pixels are removed.
class MaskedOrb final : public FrontEnd {
 public:
  MaskedOrb(const filter::OrbConfig& orb, bool use_mask) : extractor_(orb), use_mask_(use_mask) {}

  FrontEndOutput process(const camera::SourceFrame& frame) override {
    const std::int64_t start_ns = service::monotonic_ns();
    FrontEndOutput output{extractor_.extract(frame.image), {}};
    if (use_mask_) remove_masked(frame.dynamic_mask, output.features);
    output.stage_ms["filter.total"] = ms_since(start_ns);
    return output;
  }

 private:
  static void remove_masked(const cv::Mat& mask, std::vector<msg::Feature>& features) {
    if (mask.empty()) throw std::invalid_argument("true-mask: the source has no masks (tum:DIR?masks=1)");
    constexpr int kGrow_px = 3;
    cv::Mat grown;
    cv::dilate(mask, grown, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kGrow_px + 1, 2 * kGrow_px + 1}));
    for (msg::Feature& feature : features) {
      const int x = std::clamp(static_cast<int>(std::lround(feature.u_raw_px)), 0, grown.cols - 1);
      const int y = std::clamp(static_cast<int>(std::lround(feature.v_raw_px)), 0, grown.rows - 1);
      if (grown.at<std::uint8_t>(y, x) != 0) feature.flags |= msg::kFeatureRemoved;
    }
  }

  filter::OrbExtractor extractor_;
  bool use_mask_;
};

/// The dynamic filter with the inputs of slam and the detector that the service gives it.
class Filtered final : public FrontEnd {
 public:
  /// Without `look`: no detector.
  Filtered(const filter::FilterConfig& config, const Look& look, const DetectorOptions& detector,
           const std::vector<ImageFault>& faults)
      : filter_(config, service::monotonic_ns), faults_(faults) {
    if (!look) return;
    detector_.emplace([this, look](const camera::SourceFrame& frame) { return timed(look, frame); }, detector,
                      make_look_at_pixels(detector));
  }

  FrontEndOutput process(const camera::SourceFrame& frame) override {
    FrontEndOutput output;
    detector_ms_ = 0;
    const filter::DetectorUpdate update = detector_ ? detector_->advance_to(frame) : filter::DetectorUpdate{};
    if (detector_ms_ > 0) output.stage_ms["detector"] = detector_ms_;
    for (const camera::ImuReading& reading : frame.imu) {
      filter_.add({reading.stamp_ns, reading.gyro_rad_s, reading.accel_m_s2});
    }
    filter::FilterResult result = filter_.apply(frame.image, update);
    static constexpr std::array<const char*, 7> kNames{"filter.wait",       "filter.extract", "filter.masks",
                                                       "filter.ego_motion", "filter.check",   "filter.fuse",
                                                       "filter.total"};
    for (std::size_t i = 1; i < kNames.size(); ++i)
      output.stage_ms[kNames[i]] = static_cast<double>(result.stage_ms[i]);
    output.features = std::move(result.features);
    output.cells = result.cells;
    output.motion = std::move(result.motion);
    return output;
  }
  void listen(const slam::SlamOutput& output) override {
    for (const msg::KeyframeEvent& event : slam::make_events(output))
      filter_.on_keyframe(filter::to_slam_keyframe(event));
    const msg::TrackingResult result = slam::make_result(output.result);
    if (const auto pose = filter::to_slam_pose(result)) filter_.on_pose(*pose);
  }

 private:
  std::vector<vision::Detection> timed(const Look& look, const camera::SourceFrame& frame) {
    const std::int64_t start_ns = service::monotonic_ns();
    std::vector<vision::Detection> boxes = faults_.seen(frame, look(frame));
    detector_ms_ += ms_since(start_ns);
    return boxes;
  }

  filter::DynamicFilter filter_;
  ImageFaults faults_;
  std::optional<DetectorPace> detector_;
  double detector_ms_ = 0;  ///< spent for the present frame
};

bool is_filter_mode(const std::string& mode) {
  return mode != "off" && mode != "true-mask";
}

filter::FilterConfig filter_config(const FrontEndOptions& options) {
  filter::ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("filter", config);
  if (is_filter_mode(options.mode)) binder.set("filter.mode=" + options.mode);
  for (const std::string& setting : options.filter_settings) binder.set(setting);
  return config.core_config();
}

}  // namespace

std::unique_ptr<FrontEnd> make_front_end(const FrontEndOptions& options) {
  const filter::FilterConfig config = filter_config(options);
  if (!is_filter_mode(options.mode)) return std::make_unique<MaskedOrb>(config.orb, options.mode == "true-mask");
  const bool looks = options.mode != "geometry" && options.detector.kind != "off";
  return std::make_unique<Filtered>(config, looks ? make_look(options.detector) : Look{}, options.detector,
                                    options.image_faults);
}

}  // namespace rtd::test_support
