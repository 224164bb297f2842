// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "common/service/monotonic_clock.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/core/model_locator.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

double ms_since(std::int64_t start_ns) {
  return static_cast<double>(service::monotonic_ns() - start_ns) * 1e-6;
}

/// ORB features; with the source's mask those on moving pixels are removed.
class MaskedOrb final : public FrontEnd {
 public:
  explicit MaskedOrb(bool use_mask) : use_mask_(use_mask) {}

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

  filter::OrbExtractor extractor_{filter::OrbConfig{}};
  bool use_mask_;
};

/// The dynamic filter, told by slam what the service tells it, with the boxes of every frame when there is a detector.
class Filtered final : public FrontEnd {
 public:
  Filtered(const filter::FilterConfig& config, std::unique_ptr<detector::Detector> detector)
      : filter_(config, service::monotonic_ns), detector_(std::move(detector)) {}

  FrontEndOutput process(const camera::SourceFrame& frame) override {
    FrontEndOutput output;
    filter::Detections detections;
    if (detector_ != nullptr) {
      const std::int64_t start_ns = service::monotonic_ns();
      detections = detector_->detect(frame.image.color_bgr);
      output.stage_ms["detector"] = ms_since(start_ns);
    }
    filter::FilterResult result = filter_.apply(frame.image, detections);
    static constexpr std::array<const char*, 7> kNames{"filter.wait",       "filter.extract", "filter.masks",
                                                       "filter.ego_motion", "filter.check",   "filter.fuse",
                                                       "filter.total"};
    for (std::size_t i = 1; i < kNames.size(); ++i)
      output.stage_ms[kNames[i]] = static_cast<double>(result.stage_ms[i]);
    output.features = std::move(result.features);
    return output;
  }
  void listen(const slam::SlamOutput& output) override {
    for (const msg::KeyframeEvent& event : output.events) filter_.on_keyframe(event);
    filter_.on_tracking(output.result);
  }

 private:
  filter::DynamicFilter filter_;
  std::unique_ptr<detector::Detector> detector_;
};

std::unique_ptr<detector::Detector> load_detector() {
  const detector::ModelSearch model = detector::find_model("", detector::process_environment());
  if (!model) throw std::invalid_argument(model.message);
  detector::DetectorConfig config;
  config.model_path = model.path;
  return std::make_unique<detector::Detector>(config);
}

}  // namespace

std::unique_ptr<FrontEnd> make_front_end(const std::string& mode) {
  if (mode == "off" || mode == "true-mask") return std::make_unique<MaskedOrb>(mode == "true-mask");
  filter::FilterConfig config;
  if (mode == "semantic") config.mode = filter::FilterMode::kSemantic;
  if (mode == "geometry") config.mode = filter::FilterMode::kGeometry;
  if (mode == "rtd") config.mode = filter::FilterMode::kRtd;
  if (mode == "geometry") return std::make_unique<Filtered>(config, nullptr);
  if (mode == "semantic" || mode == "rtd") return std::make_unique<Filtered>(config, load_detector());
  throw std::invalid_argument("unknown mode '" + mode + "': off, true-mask, semantic, geometry, rtd");
}

}  // namespace rtd::test_support
