// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/filter_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/msg/plausible.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::filter {
namespace {

constexpr std::size_t kMaxBoxes = 300;

bool usable(const vision::Detection& box) {
  return std::isfinite(box.score) && std::isfinite(box.x_px) && std::isfinite(box.y_px) &&
         std::isfinite(box.width_px) && std::isfinite(box.height_px) && box.width_px > 0 && box.height_px > 0;
}

bool removed(const msg::Feature& feature) {
  return (feature.flags & msg::kFeatureRemoved) != 0;
}

/// Why masks cannot belong to these detections; empty when they can.
std::string misfit(const DetectionBatch& batch, const msg::FrameView& frame) {
  const vision::PersonMasks& masks = batch.masks;
  if (masks.empty()) return {};
  const auto cells = [](std::uint32_t px) { return (static_cast<int>(px) - 1) / vision::kMaskStepPx + 1; };
  const int columns = cells(frame.width), rows = cells(frame.height);
  if (masks.columns != columns || masks.rows != rows)
    return fmt::format("{}x{} labels where the frame has {}x{}", masks.columns, masks.rows, columns, rows);
  const std::uint8_t highest = *std::ranges::max_element(masks.labels);
  if (highest > batch.detections.size())
    return fmt::format("label {} of {} detections", highest, batch.detections.size());
  return {};
}

}  // namespace

DetectionBatch to_detection_batch(const msg::Detection2DArray& message) {
  DetectionBatch batch{msg::to_ns(message.header.stamp), {}};
  for (const msg::Detection2D& detection : message.detections) {
    if (detection.results.empty()) continue;
    const auto best =
        std::ranges::max_element(detection.results, {}, [](const auto& result) { return result.hypothesis.score; });
    const msg::BoundingBox2D& box = detection.bbox;
    const vision::Detection converted{best->hypothesis.class_id,
                                      static_cast<float>(best->hypothesis.score),
                                      static_cast<float>(box.center.position.x - box.size_x / 2),
                                      static_cast<float>(box.center.position.y - box.size_y / 2),
                                      static_cast<float>(box.size_x),
                                      static_cast<float>(box.size_y)};
    if (usable(converted)) batch.detections.push_back(converted);
  }
  if (batch.detections.size() > kMaxBoxes) {
    std::ranges::stable_sort(batch.detections, std::greater{}, &vision::Detection::score);
    batch.detections.resize(kMaxBoxes);
  }
  return batch;
}

MaskMessage to_person_masks(const msg::Image& message) {
  const std::size_t pixels = std::size_t{message.width} * message.height;
  if (message.encoding != "mono8" || message.step != message.width || message.data.size() != pixels)
    return {{},
            fmt::format("{}x{} px as '{}' with step {} in {} bytes; mono8 without gaps is needed", message.width,
                        message.height, message.encoding, message.step, message.data.size())};
  return {{static_cast<int>(message.width), static_cast<int>(message.height), message.data}, {}};
}

std::string drop_misfits(std::vector<DetectionBatch>& batches, const msg::FrameView& frame) {
  std::string last;
  for (DetectionBatch& batch : batches) {
    const std::string cause = misfit(batch, frame);
    if (cause.empty()) continue;
    batch.masks = {};
    last = cause;
  }
  return last;
}

std::optional<SlamPose> to_slam_pose(const msg::TrackingResult& result) {
  if (!msg::is_measured(result.state)) return std::nullopt;
  return SlamPose{result.seq, result.map_id, msg::to_isometry(result.T_world_camera)};
}

SlamKeyframe to_slam_keyframe(const msg::KeyframeEvent& event) {
  return {event.frame_seq, event.kind == msg::KeyframeEventKind::kRemoved, msg::to_isometry(event.T_world_camera)};
}

void fill_message(const msg::FrameView& frame, const FilterResult& result, msg::DetectionUse use,
                  msg::FeatureFrame& message) {
  message = {};
  message.seq = frame.seq;
  message.stamp_ns = frame.stamp_ns;
  message.published_ns = frame.published_ns;
  message.intrinsics = frame.intrinsics;
  message.readout_s = frame.readout_s;
  message.width = frame.width;
  message.height = frame.height;
  message.objects = static_cast<std::uint32_t>(result.objects.size());
  message.detection_use = use;
  message.stage_ms = result.stage_ms;
  const bool overfull = result.features.size() > msg::kMaxFeatures;
  for (const msg::Feature& feature : result.features) {
    if (message.count == msg::kMaxFeatures) break;
    if ((overfull && removed(feature)) || !msg::is_plausible(feature)) continue;
    message.features[message.count++] = feature;
    if (removed(feature)) ++message.removed;
  }
}

msg::Image make_mask(const msg::FrameView& frame, const FilterResult& result, const std::string& camera_frame) {
  const auto side_px =
      static_cast<std::uint32_t>(cell_side_px(static_cast<int>(frame.width), static_cast<int>(frame.height)));
  const auto cells = [&](std::uint32_t px) { return std::max(1U, px / side_px); };
  const bool judged = !result.motion.empty();
  msg::Image mask;
  mask.header = {msg::to_time(frame.stamp_ns), camera_frame};
  mask.width = judged ? static_cast<std::uint32_t>(result.cells.columns) : cells(frame.width);
  mask.height = judged ? static_cast<std::uint32_t>(result.cells.rows) : cells(frame.height);
  mask.encoding = "mono8";
  mask.step = mask.width;
  mask.data.resize(std::size_t{mask.width} * mask.height, static_cast<std::uint8_t>(CellMotion::kStatic));
  std::transform(result.motion.begin(), result.motion.end(), mask.data.begin(),
                 [](CellMotion motion) { return static_cast<std::uint8_t>(motion); });
  return mask;
}

}  // namespace rtd::filter
