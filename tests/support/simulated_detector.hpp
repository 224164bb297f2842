// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/service/model_locator.hpp"
#include "common/vision/detection.hpp"
#include "services/detector/core/detector_config.hpp"

namespace rtd::test_support {

/// A span in which the detector is gone, seconds after the first frame.
struct Outage {
  double begin_s = 0, end_s = 0;
};

/// How long an object is not found when misses come in bursts, and the recall at which they would fill the time.
inline constexpr double kShortestBurst_s = 0.3, kLongestBurst_s = 2, kLeastRecall = 0.45;

/// Which detector a run has, and how fast it is.
struct DetectorOptions {
  /// off; real: the network in RTD_MODEL_DIR; truth: the boxes that the source knows, a little wrong, now and then
  /// missed; lying: random boxes of random classes
  std::string kind = "real";
  double rate_hz = 0;   ///< at most so many images a second, 0 = every frame
  double delay_ms = 0;  ///< from an image to its boxes; other images wait meanwhile
  std::vector<Outage> outages;
  std::uint64_t seed = 1;        ///< of truth and lying
  double jitter_share = 0.03;    ///< truth: standard deviation of each edge, of the box's size
  double jitter_real_share = 0;  ///< the same of real's boxes
  double missed_share = 0.04;    ///< truth: boxes that are not found
  double recall = 1;             ///< truth: share of the boxes found, >= kLeastRecall; misses come in bursts
  double cut_share = 0;          ///< truth: boxes that lack a fifth to a half at one side
  int min_visible_px = 900;      ///< truth: less of an object is not found
  int max_lies = 8;              ///< lying: boxes of one image
  std::string model = service::kPaperModel;  ///< real: as `--model` of rtd run
  /// real: least score
  double confidence = detector::DecodeConfig{}.confidence_threshold;
  std::string remembered_in;  ///< real and truth: file of known answers
  /// off; truth: the source's moving pixels in its boxes of people; else: the ONNX file of a network for them
  std::string masks = "off";
  std::string masks_remembered_in;  ///< of a network: file of known answers
};

/// The boxes that a detector finds in one frame.
using Look = std::function<std::vector<vision::Detection>(const camera::SourceFrame&)>;

/// The pixels of these detections in one frame.
using LookAtPixels =
    std::function<vision::PersonMasks(const camera::SourceFrame&, const std::vector<vision::Detection>&)>;

/// As DetectorOptions::masks says; empty for off. Throws detector::ModelError for a network that cannot be used and, at
/// a frame without true masks, std::invalid_argument.
LookAtPixels make_look_at_pixels(const DetectorOptions& options);

/// What the detector of `options` finds; a pure function of seed and frame for truth and lying. Not for kind off.
/// Throws std::invalid_argument for an unknown kind and, at the first frame, for truth without SourceFrame::objects.
Look make_look(const DetectorOptions& options);

}  // namespace rtd::test_support
